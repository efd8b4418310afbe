//! A figure's numbers: groups of bars, a bar of each series in every group, a value of each person in every bar.

use std::fmt::Write as _;

use lunula_predictor::Kind;
use serde::Serialize;

/// A figure of section 5.4.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Comparison {
    /// The thesis' figure, as `105`.
    pub figure: String,
    /// What it shows.
    pub title: String,
    /// The unit of its values.
    pub unit: &'static str,
    /// The groups' names.
    pub groups: Vec<String>,
    /// The names of the bars in every group.
    pub series: Vec<String>,
    /// RMSE by group and series.
    pub cells: Vec<Vec<Spread>>,
}

/// A figure over people.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Spread {
    /// Mean of those that are known; none where none is.
    pub mean: Option<f64>,
    /// Their standard deviation (n - 1); none of fewer than two.
    pub sd: Option<f64>,
    /// Each person's; none where no model could be fitted.
    pub values: Vec<Option<f64>>,
}

impl Spread {
    fn of(values: Vec<Option<f64>>) -> Self {
        let known: Vec<f64> = values.iter().flatten().copied().collect();
        let n = known.len() as f64;
        let mean = (!known.is_empty()).then(|| known.iter().sum::<f64>() / n);
        let sd = mean.filter(|_| known.len() > 1).map(|mean| {
            let squares: f64 = known.iter().map(|value| (value - mean).powi(2)).sum();
            (squares / (n - 1.0)).sqrt()
        });
        Self { mean, sd, values }
    }
}

impl Comparison {
    /// One person's, with a value of each group and series.
    pub(super) fn new(
        figure: impl Into<String>,
        title: impl Into<String>,
        unit: &'static str,
        [groups, series]: [&[String]; 2],
        value: impl Fn(usize, usize) -> Option<f64>,
    ) -> Self {
        let cell = |group: usize, one: usize| Spread::of(vec![value(group, one).filter(|value| value.is_finite())]);
        let row = |group: usize| (0..series.len()).map(|one| cell(group, one)).collect();
        Self {
            figure: figure.into(),
            title: title.into(),
            unit,
            groups: groups.to_vec(),
            series: series.to_vec(),
            cells: (0..groups.len()).map(row).collect(),
        }
    }

    /// A Markdown table: mean and SD of each group and series.
    #[must_use]
    pub fn markdown(&self) -> String {
        let mut text = format!("**Fig. {}: {}** (RMSE, {}; mean ± SD)\n\n", self.figure, self.title, self.unit);
        let line = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
        let decimals = if self.unit == "N" { 3 } else { 2 };
        let cell_text = |cell: &Spread| match (cell.mean, cell.sd) {
            (Some(mean), Some(sd)) => format!("{mean:.decimals$} ± {sd:.decimals$}"),
            (Some(mean), None) => format!("{mean:.decimals$}"),
            (None, _) => "-".to_owned(),
        };
        text += &line(std::iter::once(String::new()).chain(self.series.iter().cloned()).collect());
        let _ = writeln!(text, "|{}", "---|".repeat(self.series.len() + 1));
        for (group, cells) in self.groups.iter().zip(&self.cells) {
            text += &line(std::iter::once(group.clone()).chain(cells.iter().map(cell_text)).collect());
        }
        text
    }
}

/// Joins each person's figures; all have to be of the same groups and series.
pub(super) fn over_people(found: Vec<Vec<Comparison>>) -> Result<Vec<Comparison>, String> {
    let mut people = found.into_iter();
    let mut all = people.next().unwrap_or_default();
    for one in people {
        for (joined, own) in all.iter_mut().zip(one) {
            if (&joined.groups, &joined.series) != (&own.groups, &own.series) {
                return Err(format!("Fig. {}: the people's photodiodes are not the same", joined.figure));
            }
            for (cell, own) in joined.cells.iter_mut().flatten().zip(own.cells.into_iter().flatten()) {
                cell.values.extend(own.values);
            }
        }
    }
    for cell in all.iter_mut().flat_map(|one| one.cells.iter_mut().flatten()) {
        *cell = Spread::of(std::mem::take(&mut cell.values));
    }
    Ok(all)
}

/// The thesis' figure of a model's validation by what it was trained on.
pub(super) fn figure_of(kind: Kind) -> &'static str {
    match kind {
        Kind::Linear => "105",
        Kind::Quadratic => "106",
        // Eigennails are none of the thesis' models, and no option of this job.
        Kind::Network { .. } | Kind::Eigennails { .. } => "107",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn one(value: Option<f64>) -> Vec<Comparison> {
        let names = ["Fx_N".to_owned()];
        vec![Comparison::new("105", "title", "N", [&names, &["both".to_owned()]], |_, _| value)]
    }

    #[test]
    fn people_are_joined_and_what_is_missing_stays_missing() {
        let joined = over_people(vec![one(Some(1.0)), one(None), one(Some(2.0)), one(Some(f64::NAN))]).unwrap();
        let cell = &joined[0].cells[0][0];
        assert_eq!(cell.values, [Some(1.0), None, Some(2.0), None]);
        assert_eq!((cell.mean, cell.sd), (Some(1.5), Some(0.5f64.sqrt())));
        let text = joined[0].markdown();
        assert!(text.contains("|  | both |\n|---|---|\n| Fx_N | 1.500 ± 0.707 |\n"), "{text}");
        let none = over_people(vec![one(None)]).unwrap();
        assert_eq!((none[0].cells[0][0].mean, none[0].cells[0][0].sd), (None, None));
        assert!(none[0].markdown().contains("| Fx_N | - |"));
    }

    #[test]
    fn people_with_other_photodiodes_are_refused() {
        let mut other = one(Some(1.0));
        other[0].groups[0] = "P9".to_owned();
        assert!(over_people(vec![one(Some(1.0)), other]).unwrap_err().contains("Fig. 105"));
    }
}
