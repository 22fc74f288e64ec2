lookout_test(NAME unit_georeferencer
             SOURCES unit/georeferencer/pose_test.cpp unit/georeferencer/placement_test.cpp unit/georeferencer/georeferencer_test.cpp
                     unit/georeferencer/wire_test.cpp unit/georeferencer/obstacle_messages_test.cpp unit/georeferencer/service_test.cpp
                     unit/georeferencer/guard_zone_test.cpp unit/georeferencer/guard_alarm_test.cpp
             LINKS lookout_georeferencer)
lookout_test(NAME property_georeferencer
             SOURCES property/georeferencer_interleaving_test.cpp property/georeferencer_round_trip_test.cpp
                     property/georeferencer_covariance_test.cpp property/georeferencer_geodesy_test.cpp property/georeferencer_far_test.cpp
             LINKS lookout_georeferencer ${GeographicLib_LIBRARIES})
lookout_bench(NAME bench_georeferencer SOURCES bench/georeferencer_bench.cpp LINKS lookout_georeferencer)
lookout_fuzz(NAME fuzz_georeferencer SOURCES fuzz/georeferencer_fuzz.cpp LINKS lookout_georeferencer)
lookout_test(NAME property_georeferencer_obstacles SOURCES property/georeferencer_obstacles_test.cpp
             LINKS lookout_eval lookout_replay lookout_sim lookout_config lookout_bus TIMEOUT 300)
lookout_slow_test(NAME property_georeferencer_obstacles ENVIRONMENT LOOKOUT_OBSTACLE_SEEDS=20)
lookout_test(NAME property_georeferencer_alarm SOURCES property/georeferencer_alarm_test.cpp
             LINKS lookout_replay lookout_sim lookout_config lookout_bus TIMEOUT 180)
lookout_slow_test(NAME property_georeferencer_alarm ENVIRONMENT LOOKOUT_ALARM_SECONDS=80)
