//! Which picture of which part is the counterpart of which figure of the thesis.

use super::Part;

/// A figure of the thesis, or one that the thesis has not.
#[derive(Debug, Clone, Copy)]
pub(super) struct Figure {
    /// In the thesis; a name where the thesis has none.
    pub(super) number: &'static str,
    /// The part that has its counterpart.
    pub(super) part: Part,
    /// The picture in the part's folder, without `.png`.
    pub(super) picture: &'static str,
    /// What it shows.
    pub(super) caption: &'static str,
}

pub(super) struct Section {
    /// The name that links go to.
    pub(super) name: &'static str,
    pub(super) title: &'static str,
    /// Prefixes of the numbers of the sections whose statements are shown here.
    pub(super) of: &'static [&'static str],
    pub(super) figures: &'static [Figure],
}

impl Figure {
    /// What the page calls it.
    pub(super) fn label(&self) -> String {
        let is_numbered = self.number.starts_with(|first: char| first.is_ascii_digit());
        if is_numbered { format!("Fig. {}", self.number) } else { self.number.to_owned() }
    }
}

const fn figure(number: &'static str, part: Part, picture: &'static str, caption: &'static str) -> Figure {
    Figure { number, part, picture, caption }
}

/// All data figures, in the thesis' order.
pub(super) const SECTIONS: &[Section] = &[
    Section {
        name: "colours",
        title: "2.3 and 2.4 The nail's colour, and what sensors see of it",
        of: &["2.3", "2.4"],
        figures: &[
            figure("5", Part::Rising, "rising", "One nail under rising normal force, filmed; contrast stretched."),
            figure(
                "Sensor and camera",
                Part::FilmGreen,
                "traces",
                "What photodiodes on the nail and a camera over it see at the same places, the camera's green brought \
                 to the sensor's volts by a straight line; random touching, held out.",
            ),
            figure(
                "Errors of both",
                Part::FilmGreen,
                "rmse",
                "Linear touch models of the sensor and of the camera's green, on the path held out.",
            ),
            figure(
                "Errors, green over red",
                Part::FilmRatio,
                "rmse",
                "The same with the light taken off by the red of the same place.",
            ),
        ],
    },
    Section {
        name: "responses",
        title: "3.3 Responses of the sensor to force and bending",
        of: &["3.3", "7.1"],
        figures: &[
            figure("23", Part::Normal, "moves", "Normal force is cycled, shear held at zero."),
            figure("24", Part::Normal, "outputs", "Outputs over time as normal force is cycled."),
            figure("25", Part::Normal, "averages", "Outputs over normal force, averaged over cycles."),
            figure("26", Part::Lateral, "moves", "Lateral shear is cycled while the finger presses."),
            figure("27", Part::Lateral, "outputs", "Outputs over time as lateral shear is cycled."),
            figure("28", Part::Lateral, "averages", "Outputs over lateral shear, averaged over cycles."),
            figure("29", Part::Longitudinal, "moves", "Longitudinal shear is cycled while the finger presses."),
            figure("30", Part::Longitudinal, "outputs", "Outputs over time as longitudinal shear is cycled."),
            figure("31", Part::Longitudinal, "averages", "Outputs over longitudinal shear, averaged over cycles."),
            figure("32", Part::Bending, "outputs", "Outputs over time as the finger bends, one cycle."),
            figure("33", Part::Bending, "coupling", "The distal joint's angle over the middle joint's."),
            figure("34", Part::Bending, "averages", "Outputs over the middle joint's angle, averaged over cycles."),
        ],
    },
    Section {
        name: "coloration",
        title: "4.2 Coloration of the nail",
        of: &["4.2"],
        figures: &[
            figure("51", Part::Typical, "typical", "One subject's nail in all poses."),
            figure("52", Part::Typical, "typical-contrast", "The same, contrast five times: 30 to 50 % stretched."),
            figure("53", Part::Photos, "figures/mean", "Average over all subjects."),
            figure("54", Part::Photos, "figures/contrast", "The average, contrast five times: 30 to 50 % stretched."),
            figure("55", Part::Photos, "figures/threshold", "The average above 105 of 255."),
            figure("56", Part::Photos, "figures/sd", "Standard deviation over subjects, contrast five times."),
            figure("57", Part::Photos, "figures/nominal-contrast", "The nominal pose of Fig. 54, enlarged."),
            figure("58", Part::Photos, "figures/normal-contrast", "Normal force, enlarged."),
            figure("60", Part::Photos, "figures/extension-contrast", "Extension, enlarged."),
            figure("61", Part::Photos, "figures/flexion-contrast", "Flexion, enlarged."),
            figure("64", Part::Photos, "figures/lateral_negative-contrast", "Negative lateral shear, enlarged."),
            figure("65", Part::Photos, "figures/lateral_positive-contrast", "Positive lateral shear, enlarged."),
            figure(
                "67",
                Part::Photos,
                "figures/longitudinal_negative-contrast",
                "Negative longitudinal shear, enlarged.",
            ),
            figure(
                "68",
                Part::Photos,
                "figures/longitudinal_positive-contrast",
                "Positive longitudinal shear, enlarged.",
            ),
        ],
    },
    Section {
        name: "hemodynamics",
        title: "4.3 The hemodynamic model and its experiments",
        of: &["4.3"],
        figures: &[
            figure("76", Part::Section, "fig-76-literal", "Steps of proximal pressure, the thesis' values as printed."),
            figure(
                "76 (tuned)",
                Part::Section,
                "fig-76-tuned",
                "The same, stiffness and damping tuned to the measured time constants.",
            ),
            figure("77", Part::Section, "fig-77-literal", "Steps of proximal and distal pressure, values as printed."),
            figure("77 (tuned)", Part::Section, "fig-77-tuned", "The same, tuned."),
            figure("78", Part::Section, "fig-78", "Steady outputs over pressure, at one place and at both."),
            figure(
                "79",
                Part::Presses,
                "fig-79",
                "Proximal photodiode over a slow force, each subject and the average.",
            ),
            figure(
                "80",
                Part::Presses,
                "fig-80",
                "Proximal photodiode under quick presses, two subjects, and the fitted model.",
            ),
            figure("81", Part::Presses, "fig-81", "Distal photodiode over a slow force, each subject and the average."),
            figure(
                "82",
                Part::Presses,
                "fig-82",
                "Distal photodiode under quick presses, two subjects, and the fitted model.",
            ),
        ],
    },
    Section {
        name: "predictors",
        title: "5.2 and 5.3 Calibration, and predictors of touch and posture of one subject",
        of: &["5.2", "5.3"],
        figures: &[
            figure(
                "88",
                Part::Section,
                "fig-88",
                "A photodiode under a steadily growing force, with and without dynamics.",
            ),
            figure(
                "89",
                Part::Calibration,
                "trajectory-cone",
                "The cone of forces that friction allows, and the trajectory within.",
            ),
            figure(
                "90 and 93",
                Part::Calibration,
                "trajectory-path",
                "Shear of the calibration trajectory, by thirds of the force.",
            ),
            figure(
                "91 and 92",
                Part::Calibration,
                "trajectory-force",
                "The forces over time, their shear over time, and over pressing.",
            ),
            figure("94", Part::TouchTraining, "over-time", "Touch: training data and the linear model's predictions."),
            figure("95", Part::TouchTraining, "scatter", "Touch: predicted over measured, training data."),
            figure("96", Part::TouchValidation, "over-time", "Touch: the third spiral, which validates."),
            figure("97", Part::TouchValidation, "scatter", "Touch: predicted over measured, the third spiral."),
            figure("98", Part::Modes, "modes", "Singular values and modes of the linear touch model."),
            figure("99", Part::TouchTest, "over-time", "Touch: random touching."),
            figure("100", Part::TouchTest, "scatter", "Touch: predicted over measured, random touching."),
            figure("101", Part::PostureTraining, "over-time", "Posture: the half that is trained on, and predictions."),
            figure("102", Part::PostureTraining, "scatter", "Posture: predicted over measured, the half trained on."),
            figure("103", Part::PostureValidation, "over-time", "Posture: the second half, which validates."),
            figure("104", Part::PostureValidation, "scatter", "Posture: predicted over measured, the second half."),
        ],
    },
    Section {
        name: "comparison",
        title: "5.4 and 5.5 Models compared, photodiodes removed",
        of: &["5.4", "5.5"],
        figures: &[
            figure(
                "105",
                Part::Compare,
                "fig-105",
                "Linear touch model on the third repetition, by what it was trained on.",
            ),
            figure("106", Part::Compare, "fig-106", "Polynomial touch model, likewise."),
            figure("107", Part::Compare, "fig-107", "Network touch model, likewise."),
            figure("108", Part::Compare, "fig-108", "Touch models on the rows trained on."),
            figure("109", Part::Compare, "fig-109", "Touch models on the third repetition."),
            figure("110", Part::Compare, "fig-110", "Touch models on random touching."),
            figure("111", Part::Compare, "fig-111", "Linear touch model with bending in its training and without."),
            figure("112", Part::Compare, "fig-112", "Posture models."),
            figure("113", Part::Compare, "fig-113", "Linear touch model, a photodiode removed."),
        ],
    },
    Section {
        name: "switches",
        title: "Appendix C Virtual switches and a teaching pendant",
        of: &["C"],
        figures: &[
            figure(
                "123",
                Part::Performance,
                "performance-operators",
                "Time per decision, each operator's trials. The thesis shows four operators here, and says that \
                 Fig. 124 averages five.",
            ),
            figure(
                "124",
                Part::Performance,
                "performance-methods",
                "Time per decision, mean and SD over operators, with the learning curves.",
            ),
        ],
    },
];
