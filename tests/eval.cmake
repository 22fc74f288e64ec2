lookout_test(NAME unit_eval
             SOURCES unit/eval/geometry_test.cpp unit/eval/metrics_test.cpp unit/eval/truth_test.cpp unit/eval/turn_collector_test.cpp
                     unit/eval/evaluation_test.cpp unit/eval/seen_footprint_test.cpp unit/eval/machine_test.cpp unit/eval/table_test.cpp unit/eval/scoring_test.cpp
                     unit/eval/scoring_laws_test.cpp
             LINKS lookout_eval)
lookout_test(NAME unit_default_method SOURCES unit/eval/default_method_test.cpp LINKS lookout_eval_methods lookout_config)
lookout_test(NAME unit_method_comparison SOURCES unit/eval/method_comparison_test.cpp LINKS lookout_eval_methods lookout_config TIMEOUT 180)
lookout_test(NAME unit_captures SOURCES unit/eval/captures_test.cpp LINKS lookout_eval_methods lookout_config lzma TIMEOUT 120)
lookout_test(NAME system_eval_line SOURCES system/eval_line_test.cpp TIMEOUT 120)
add_dependencies(system_eval_line lookout-eval)
lookout_test(NAME unit_figures SOURCES unit/eval/figures_test.cpp LINKS lookout_eval_methods)
