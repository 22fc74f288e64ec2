lookout_test(NAME unit_segmenter
             SOURCES unit/segmenter/returns_test.cpp unit/segmenter/range_image_test.cpp unit/segmenter/breadth_first_search_test.cpp
                     unit/segmenter/component_labelling_test.cpp unit/segmenter/component_clustering_test.cpp unit/segmenter/footprint_test.cpp
                     unit/segmenter/measure_test.cpp unit/segmenter/segmenter_test.cpp unit/segmenter/turn_gatherer_test.cpp
                     unit/segmenter/wire_test.cpp unit/segmenter/service_test.cpp
             LINKS lookout_segmenter lookout_config)
lookout_test(NAME unit_segmenter_lookout
             SOURCES unit/segmenter/lookout_runs_test.cpp unit/segmenter/lookout_pieces_test.cpp
                     unit/segmenter/lookout_land_test.cpp unit/segmenter/lookout_objects_test.cpp
                     unit/segmenter/lookout_jetties_test.cpp unit/segmenter/lookout_shape_test.cpp
                     unit/segmenter/lookout_thin_test.cpp
             LINKS lookout_segmenter_core)
lookout_test(NAME unit_segmenter_lookout_edges SOURCES unit/segmenter/lookout_edges_test.cpp unit/wire/counting_new.cpp LINKS lookout_segmenter_core)
lookout_test(NAME property_segmenter SOURCES property/segmenter_reference_test.cpp property/segmenter_laws_test.cpp LINKS lookout_segmenter)
lookout_test(NAME property_segmenter_lookout SOURCES property/segmenter_lookout_test.cpp LINKS lookout_segmenter)
lookout_bench(NAME bench_segmenter SOURCES bench/segmenter_bench.cpp LINKS lookout_segmenter_core)
# Whole turns beside those of the peers. Not a Google Benchmark.
add_executable(turns_segmenter bench/segmenter_turns.cpp)
target_link_libraries(turns_segmenter PRIVATE lookout_segmenter_core lookout_eval_baselines)
lookout_bench_options(turns_segmenter)
lookout_fuzz(NAME fuzz_segmenter SOURCES fuzz/segmenter_fuzz.cpp LINKS lookout_segmenter)
