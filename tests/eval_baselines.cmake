lookout_test(NAME unit_eval_baselines
             SOURCES unit/eval_baselines/point_tree_test.cpp unit/eval_baselines/euclidean_test.cpp unit/eval_baselines/depth_clustering_test.cpp
                     unit/eval_baselines/f3d_test.cpp
             LINKS lookout_eval_baselines)
lookout_test(NAME unit_import
             SOURCES unit/import/kitti_test.cpp unit/import/pcd_test.cpp unit/import/organise_test.cpp
             LINKS lookout_import lookout_segmenter)
lookout_fuzz(NAME fuzz_point_file SOURCES fuzz/point_file_fuzz.cpp LINKS lookout_import)
