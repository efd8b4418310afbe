//! What the library and the command line promise, seen from outside. One program, for each would link the whole library
//! again; `cargo test --test all photos::` runs the tests of one file.

mod align;
mod align_bad_input;
mod camera;
mod channels;
mod cluster;
mod compare;
mod detection;
mod digits;
mod disks;
mod doctor;
#[cfg(all(target_os = "linux", target_arch = "x86_64"))]
mod faults;
mod fit;
mod fixtures;
mod house;
mod mask_outlines;
mod merge;
mod nail_axes;
mod nail_axes_drawn;
mod parsers;
mod phantom_log;
mod phantom_nail;
mod phantom_photos;
mod phantom_study;
mod phantom_video;
mod photos;
mod photos_bad_input;
mod photos_doubtful;
mod pipeline;
mod pipeline_models;
mod pipeline_pictures;
mod posture;
mod posture_bad_input;
mod predictor_analysis;
mod predictor_bad_input;
mod predictor_deficient;
mod predictor_evaluate;
mod predictor_predict;
mod predictor_train;
mod simulate;
mod simulate_extremes;
mod stdout;
mod trajectory;
mod util;
mod video;
