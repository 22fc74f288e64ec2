lookout_test(NAME unit_eval_report
             SOURCES unit/eval_report/html_test.cpp unit/eval_report/plot_test.cpp unit/eval_report/worst_turn_test.cpp
                     unit/eval_report/report_html_test.cpp
             LINKS lookout_eval_report)
