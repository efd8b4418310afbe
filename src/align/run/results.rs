//! What the alignment job writes: the labelled set, its certificate and report, exports and pictures.

use std::path::{Path, PathBuf};

use crate::align::certificate::Certificate;
use crate::align::error::AlignError;
use crate::align::export::{self, BidsNames};
use crate::align::figures;
use crate::align::label::Labels;
use crate::align::options::{AlignInputs, AlignOptions, AlignOutputs};
use crate::align::posture::Posture;
use crate::align::run::report::AlignReport;
use crate::align::tie::Tie;
use crate::files::{Places, beside, json_text};
use crate::log::Samples;
use crate::table::{Column, TableWriter, Value};

/// Decimals of a label in degrees.
pub(in crate::align) const ANGLE_DECIMALS: usize = 5;
/// Columns of text.
pub(in crate::align) const TEXTS: [&str; 4] = ["label_status", "subject", "session", "sensor_status"];

/// Results in the making.
pub(in crate::align) struct Results {
    places: Places,
}

impl Results {
    /// Refuses to replace an input.
    pub(in crate::align) fn start(inputs: &AlignInputs, outputs: &AlignOutputs) -> Result<Self, AlignError> {
        let given = [Some(&inputs.joints), Some(&inputs.log), inputs.tracks.as_ref()];
        let places = Places::not_over(given.into_iter().flatten());
        let written = [Some(&outputs.training), outputs.mot.as_ref(), outputs.dlc.as_ref()];
        places.check(written.into_iter().flatten())?;
        Ok(Self { places })
    }

    /// Writes the labelled set and its certificate.
    pub(in crate::align) fn training(
        &mut self,
        samples: &Samples,
        posture: &Posture,
        labels: &Labels,
        certificate: &Certificate,
        options: &AlignOptions,
        outputs: &AlignOutputs,
    ) -> Result<(), AlignError> {
        let path = &outputs.training;
        let channels = || samples.photodiodes.iter().chain(&samples.forces);
        let mut columns = vec![Column::number("time_s")];
        columns.extend(channels().map(|channel| Column::number(&channel.name)));
        for ending in ["_deg", "_sd_deg"] {
            columns.extend(posture.joints.iter().map(|j| Column::rounded(format!("{j}{ending}"), ANGLE_DECIMALS)));
        }
        columns.extend(TEXTS.map(Column::text));
        let text = json_text(&certificate);
        let at = self.places.place(path)?;
        let mut table = TableWriter::create(&at, path, columns, &facts(&text))?;
        let [subject, session] = [&options.subject, &options.session].map(|name| name.as_deref().unwrap_or_default());
        table.write_rows(samples.time_s.len(), &|row, write| {
            let mut cells = vec![Value::Number(samples.time_s[row])];
            cells.extend(channels().map(|channel| Value::Number(channel.values[row])));
            for columns in [&labels.angles_deg, &labels.sds_deg] {
                cells.extend(columns.iter().map(|column| Value::Number(column[row])));
            }
            let fault = samples.faults[row].as_str();
            let sensor = if fault.is_empty() { "ok" } else { fault };
            let status = labels.status(row);
            cells.extend([status.as_ref(), subject, session, sensor].map(Value::Text));
            write(&cells);
        })?;
        table.finish()?;
        Ok(self.places.write(&beside(path, ".sync.json"), &text)?)
    }

    /// Writes what other tools read; returns what of it a user should know.
    pub(in crate::align) fn exports(
        &mut self,
        posture: &Posture,
        tie: &Tie,
        names: Option<&BidsNames>,
        inputs: &AlignInputs,
        outputs: &AlignOutputs,
    ) -> Result<Vec<String>, AlignError> {
        let mut notes = Vec::new();
        if let Some(path) = &outputs.mot {
            let left_out = export::mot(&self.places.place(path)?, path, posture, tie)?;
            if left_out > 0 {
                let frames = posture.time_s.len();
                notes.push(format!(
                    "{}: {left_out} of {frames} frames lack an angle and are left out, as OpenSim knows no missing \
                     ones",
                    path.display()
                ));
            }
        }
        if let Some((root, names)) = outputs.bids.as_ref().zip(names) {
            export::bids(&mut self.places, root, names, posture, tie)?;
        }
        if let Some((path, tracks)) = outputs.dlc.as_ref().zip(inputs.tracks.as_ref()) {
            export::dlc(&self.places.place(path)?, path, tracks, posture)?;
        }
        Ok(notes)
    }

    /// Draws the pictures beside the set; returns where those that a person looks at will stand.
    pub(in crate::align) fn pictures(
        &mut self,
        posture: &Posture,
        samples: &Samples,
        labels: &Labels,
        tie: &Tie,
        outputs: &AlignOutputs,
    ) -> Result<Vec<PathBuf>, AlignError> {
        if !outputs.figures {
            return Ok(Vec::new());
        }
        let set = &outputs.training;
        let draw_labels = |png: &Path, svg: &Path| figures::draw_labels(samples, labels, png, svg);
        let mut pictures = vec![self.places.draw(set, "labels", draw_labels)?];
        if !tie.residuals_s.is_empty() {
            let draw_tie = |png: &Path, svg: &Path| figures::draw_tie(tie, posture, png, svg).map(drop);
            pictures.push(self.places.draw(set, "tie", draw_tie)?);
        }
        Ok(pictures)
    }

    /// Puts everything into its place, with the report where it is wanted.
    pub(in crate::align) fn finish(
        self,
        report: AlignReport,
        outputs: &AlignOutputs,
    ) -> Result<AlignReport, AlignError> {
        let at = outputs.report.then(|| beside(&outputs.training, ".run.json"));
        Ok(report.commit(self.places, at.as_deref())?)
    }
}

/// What Parquet keeps beside the cells.
fn facts(certificate: &str) -> Vec<(String, String)> {
    [
        ("lunula", env!("CARGO_PKG_VERSION")),
        ("time_s", "the log's own time, seconds"),
        ("photodiodes", "volts, the ambient light taken away where the log has a column `led`"),
        ("forces", "newtons, of the finger on the surface: pressing down is negative Fz_N"),
        ("angles", "degrees, positive in flexion; J1 MP, J2 PIP, J3 DIP"),
        ("sd", "standard error of the label, the tie of the clocks included, degrees"),
        ("certificate", certificate),
    ]
    .map(|(key, value)| (key.to_owned(), value.to_owned()))
    .to_vec()
}
