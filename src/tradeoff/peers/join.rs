//! Other programs' rows beside those measured here.

use anyhow::{Context, ensure};

use super::report::{PeerReport, program};
use super::table::PeerRow;
use crate::tradeoff::measure::rows::Row;
use crate::tradeoff::measure::timing::Timing;

/// Puts the rows of `scene` among `others`, all of one job, beside those measured here; what became of each program.
///
/// # Errors
/// A row whose error is none of its choice's curves, or that is there twice.
pub(in crate::tradeoff) fn join(
    rows: &mut Vec<Row>,
    scene: &str,
    others: &[&PeerRow],
) -> anyhow::Result<Vec<PeerReport>> {
    let mut reports: Vec<PeerReport> = Vec::new();
    for other in others {
        let PeerRow { setting, error_unit, .. } = other;
        let report = if other.scene == scene {
            let on = rows.iter().filter(|row| row.choice == other.choice);
            let own = on.clone().find(|row| row.error_unit == *error_unit).with_context(|| {
                let mut units: Vec<&str> = on.map(|row| row.error_unit.as_str()).collect();
                units.sort_unstable();
                units.dedup();
                let units = units.join("`, `");
                format!("{setting}: no curve of {} has the error `{error_unit}`; one of `{units}`", other.choice)
            })?;
            let twice = rows.iter().any(|row| row.peer && row.setting == *setting && row.error_unit == *error_unit);
            ensure!(!twice, "{setting}: two rows for the error `{error_unit}`; give one of them to --peers");
            rows.push(of(other, own.job, own.choice));
            let what = format!("{}; measured on {}, {}", other.version, other.machine, other.date);
            PeerReport { peer: program(setting).to_owned(), measured: true, what }
        } else {
            let what = format!("its figures are of another scene ({}); this one is {scene}", other.scene);
            PeerReport { peer: program(setting).to_owned(), measured: false, what }
        };
        if !reports.contains(&report) {
            reports.push(report);
        }
    }
    if reports.is_empty() {
        let what = "not measured; --peers FILE.csv takes their figures, which `make peers` of the repository measures";
        reports.push(PeerReport { peer: "other programs".to_owned(), measured: false, what: what.to_owned() });
    }
    Ok(reports)
}

fn of(other: &PeerRow, job: &'static str, choice: &'static str) -> Row {
    let time = Timing {
        median_s: other.run_s,
        low_s: other.run_low_s,
        high_s: other.run_high_s,
        repeats: other.repeats as usize,
    };
    let error = (other.error, other.error_unit.as_str());
    Row { peer: true, ..Row::own((job, choice), &other.setting, error, time, other.work) }
}

#[cfg(test)]
mod tests {
    use super::super::table::tests::other;
    use super::*;
    use crate::tradeoff::judge::tests::{judged, row};
    use crate::tradeoff::photos::OUTLINE_ERROR;

    #[test]
    fn rows_of_the_same_scene_come_onto_the_curve() {
        let far = PeerRow { scene: "seed 2".to_owned(), ..other("Far", 0.1, 1.0) };
        let found = judged(vec![row("a", 1.0, 0.1)], &[other("Other, fast", 0.2, 3.5), far]).unwrap();
        let peers: Vec<&Row> = found.rows.iter().filter(|row| row.peer).collect();
        assert_eq!(peers.len(), 1);
        assert_eq!((peers[0].setting.as_str(), peers[0].run_s, peers[0].choice), ("Other, fast", 3.5, "detection"));
        assert_eq!(found.curves[0].peer.as_ref().unwrap().setting, "Other, fast");
        let reports: Vec<_> = found.peers.iter().map(|one| (one.peer.as_str(), one.measured)).collect();
        assert_eq!(reports, [("Other", true), ("Far", false)]);
        assert!(found.peers[0].what.contains("Other 2.1; measured on a laptop, 4 cores, 2026-11-22"));
        assert!(found.peers[1].what.contains("(seed 2)"), "{:?}", found.peers[1]);
    }

    #[test]
    fn without_tables_it_says_what_is_left_out() {
        let found = judged(vec![row("a", 1.0, 0.1)], &[]).unwrap();
        assert!(!found.peers[0].measured && found.peers[0].what.contains("--peers FILE.csv"), "{:?}", found.peers);
    }

    #[test]
    fn a_row_that_fits_no_curve_or_is_there_twice_is_refused() {
        let metres = PeerRow { error_unit: "metres".to_owned(), ..other("A", 1.0, 1.0) };
        let why = judged(vec![row("a", 1.0, 0.1)], &[metres]).unwrap_err().to_string();
        assert!(why.contains("`metres`") && why.contains(OUTLINE_ERROR), "{why}");
        let why = judged(vec![row("a", 1.0, 0.1)], &[other("A", 1.0, 1.0), other("A", 2.0, 1.0)]).unwrap_err();
        assert!(why.to_string().contains("two rows"), "{why}");
    }
}
