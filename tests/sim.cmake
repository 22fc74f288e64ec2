lookout_test(NAME unit_sim
             SOURCES unit/sim/random_test.cpp unit/sim/solid_test.cpp unit/sim/motion_test.cpp unit/sim/ray_caster_test.cpp unit/sim/scene_test.cpp
                     unit/sim/lidar_test.cpp unit/sim/nmea_test.cpp unit/sim/simulation_test.cpp unit/sim/pcap_sink_test.cpp
                     unit/sim/faults_test.cpp
             LINKS lookout_sim pcap TIMEOUT 120)
lookout_test(NAME property_vlp16_faults SOURCES property/vlp16_faults_test.cpp LINKS lookout_sim lookout_vlp16 lookout_vlp16_io TIMEOUT 180)
