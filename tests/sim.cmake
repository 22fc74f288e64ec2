lookout_test(NAME unit_sim
             SOURCES unit/sim/random_test.cpp unit/sim/solid_test.cpp unit/sim/motion_test.cpp unit/sim/ray_caster_test.cpp unit/sim/scene_test.cpp
                     unit/sim/scene_file_test.cpp unit/sim/sea_test.cpp unit/sim/traffic_test.cpp
                     unit/sim/lidar_test.cpp unit/sim/effects_test.cpp unit/sim/clutter_test.cpp unit/sim/truth_log_test.cpp unit/sim/simulation_test.cpp unit/sim/pcap_sink_test.cpp
                     unit/sim/faults_test.cpp unit/sim/schedule_test.cpp
             LINKS lookout_sim lookout_wire pcap TIMEOUT 300)
lookout_test(NAME property_vlp16_faults SOURCES property/vlp16_faults_test.cpp LINKS lookout_sim lookout_vlp16 lookout_vlp16_io TIMEOUT 180)
lookout_bench(NAME bench_sim SOURCES bench/sim_bench.cpp LINKS lookout_sim lookout_config)
lookout_test(NAME unit_sim_navigation
             SOURCES unit/sim/fault_plan_test.cpp unit/sim/clock_faults_test.cpp unit/sim/imu_test.cpp unit/sim/navigation_test.cpp unit/sim/nmea_test.cpp
             LINKS lookout_sim lookout_navigator_core lookout_vlp16_core TIMEOUT 300)
lookout_test(NAME property_vlp16_clock_faults SOURCES property/vlp16_clock_faults_test.cpp LINKS lookout_sim lookout_vlp16_core TIMEOUT 180)
lookout_bench(NAME bench_navigator SOURCES bench/navigator_bench.cpp LINKS lookout_sim lookout_navigator lookout_config)
lookout_test(NAME property_navigator_accuracy SOURCES property/navigator_accuracy_test.cpp LINKS lookout_sim lookout_navigator lookout_config TIMEOUT 300)
lookout_test(NAME property_sim_wire_truth SOURCES property/sim_wire_truth_test.cpp LINKS lookout_sim lookout_wire pcap TIMEOUT 180)
lookout_test(NAME unit_sim_options SOURCES unit/sim/options_test.cpp ../tools/sim/options.cpp
             LINKS lookout_sim lookout_config lookout_config_schema lookout_runtime lookout_wire)
lookout_slow_test(NAME property_navigator_accuracy ENVIRONMENT LOOKOUT_NAVIGATOR_SEEDS=20)
