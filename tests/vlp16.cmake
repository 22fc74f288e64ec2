lookout_test(NAME unit_io SOURCES unit/io/ip_address_test.cpp unit/io/udp_receiver_test.cpp LINKS lookout_io)
lookout_test(NAME unit_vlp16
             SOURCES unit/vlp16/bundler_test.cpp unit/vlp16/capture_player_test.cpp unit/vlp16/capture_test.cpp unit/vlp16/live_capture_test.cpp unit/vlp16/data_packet_test.cpp unit/vlp16/decoder_test.cpp unit/vlp16/foreign_sensor_test.cpp
                     unit/vlp16/model_test.cpp unit/vlp16/packet_sequencer_test.cpp unit/vlp16/params_test.cpp unit/vlp16/position_packet_test.cpp
                     unit/vlp16/sender_lock_test.cpp unit/vlp16/sensor_clock_test.cpp unit/vlp16/service_test.cpp
             LINKS lookout_vlp16 lookout_vlp16_io lookout_config pcap)
lookout_test(NAME property_vlp16 SOURCES property/vlp16_turns_test.cpp LINKS lookout_vlp16)
lookout_test(NAME property_vlp16_clock SOURCES property/vlp16_clock_disturbances_test.cpp LINKS lookout_vlp16 TIMEOUT 180)
lookout_bench(NAME bench_vlp16 SOURCES bench/vlp16_bench.cpp LINKS lookout_vlp16)
lookout_fuzz(NAME fuzz_data_packet SOURCES fuzz/data_packet_fuzz.cpp LINKS lookout_vlp16)
lookout_fuzz(NAME fuzz_position_packet SOURCES fuzz/position_packet_fuzz.cpp LINKS lookout_vlp16_core)
lookout_fuzz(NAME fuzz_capture SOURCES fuzz/capture_fuzz.cpp LINKS lookout_vlp16_io)
