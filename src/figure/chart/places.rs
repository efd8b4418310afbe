//! Ticks of logarithmic axes, and where the labels of points go.
//!
//! In: the axis' range; boxes that are taken, pixels from the top left. Out: ticks; for each label the step from its
//! point to its top left corner.

use std::ops::Range;

/// About the width of a letter and the height of a label, pixels.
pub(super) const LETTER_PX: i32 = 7;
const LINE_PX: i32 = 15;
/// A label below its point begins this much lower.
const BELOW_PX: i32 = 4;
/// Up to this many decades have a tick each.
const MOST_TICKS: i32 = 14;

/// Left, top, right, bottom.
pub(super) type Place = [i32; 4];

/// Ticks with a number and ticks without, from `low` to `high`; the fewer decades, the more numbers in each.
pub(super) fn ticks(low: f64, high: f64) -> (Vec<f64>, Vec<f64>) {
    let (first, last) = (low.log10().floor() as i32, high.log10().ceil() as i32);
    let multiples = |of: &[i32], step: i32| -> Vec<f64> {
        let decades = (first..=last).filter(|decade| decade.rem_euclid(step) == 0);
        // Parsed, not multiplied: 3e-1 is not 0.30000000000000004.
        let all = decades.flat_map(|decade| of.iter().filter_map(move |k| format!("{k}e{decade}").parse().ok()));
        all.filter(|tick| (low..=high).contains(tick)).collect()
    };
    let decades = (high / low).log10();
    let step = ((last - first) / MOST_TICKS + 1).max(1);
    let named: &[i32] = match decades {
        d if d < 1.0 => &[1, 2, 3, 4, 5, 6, 7, 8, 9],
        d if d < 1.7 => &[1, 2, 3, 5],
        d if d < 3.5 => &[1, 2, 5],
        _ => &[1],
    };
    let light: &[i32] = if step == 1 { &[1, 2, 3, 4, 5, 6, 7, 8, 9] } else { &[1] };
    (multiples(named, step), multiples(light, 1))
}

/// For each label the step from its point `(x, y)`, past the `clear` pixels about it: within `across` and `down`, and,
/// where there is room, on none of the places `taken` and on no other label.
pub(super) fn label_steps(
    points: &[((i32, i32), i32, &str)],
    mut taken: Vec<Place>,
    across: &Range<i32>,
    down: &Range<i32>,
) -> Vec<(i32, i32)> {
    let beside = |&((x, y), clear, name): &((i32, i32), i32, &str)| {
        let width = name.chars().count() as i32 * LETTER_PX;
        let place = |(dx, dy): (i32, i32)| [x + dx, y + dy, x + dx + width, y + dy + LINE_PX];
        let free = |step: &(i32, i32)| {
            let [left, top, right, bottom] = place(*step);
            let inside = left >= across.start && right <= across.end && top >= down.start && bottom <= down.end;
            inside && taken.iter().all(|t| t[2] < left || t[0] > right || t[3] < top || t[1] > bottom)
        };
        // Right above, right below, left above, left below, then further off.
        let (right, left) = (clear + 3, -clear - 3 - width);
        let mut steps = (0..12).flat_map(|k| {
            let (above, below) = (-LINE_PX - k * LINE_PX, BELOW_PX + k * LINE_PX);
            [(right, above), (right, below), (left, above), (left, below)]
        });
        let otherwise = (if x + right + width > across.end { left } else { right }, BELOW_PX);
        let step = steps.find(free).unwrap_or(otherwise);
        taken.push(place(step));
        step
    };
    points.iter().map(beside).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_axis_within_a_decade_has_numbers() {
        let (named, light) = ticks(0.23, 0.93);
        assert_eq!(named, [0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9]);
        assert_eq!(named, light);
        assert_eq!(ticks(0.5, 30.0).0, [0.5, 1.0, 2.0, 5.0, 10.0, 20.0]);
        assert_eq!(ticks(2e-4, 3.0).0, [0.001, 0.01, 0.1, 1.0]);
    }

    #[test]
    fn many_decades_have_no_more_ticks_than_can_be_read() {
        let (named, light) = ticks(1e-30, 1e10);
        assert!((5..=15).contains(&named.len()) && named.len() < light.len());
    }

    #[test]
    fn labels_keep_clear_of_marks_dots_and_each_other() {
        // A mark about the first point, the second beside it, the legend above, the edge at the right.
        let points = [((100, 50), 11, "first"), ((130, 50), 5, "second"), ((190, 50), 5, "third")];
        let taken = vec![[89, 39, 111, 61], [125, 45, 135, 55], [185, 45, 195, 55], [60, 0, 200, 40]];
        let steps = label_steps(&points, taken.clone(), &(0..200), &(0..200));
        let places: Vec<Place> = points
            .iter()
            .zip(&steps)
            .map(|(((x, y), _, name), (dx, dy))| {
                let (left, top) = (x + dx, y + dy);
                [left, top, left + name.len() as i32 * LETTER_PX, top + LINE_PX]
            })
            .collect();
        let apart = |a: &Place, b: &Place| a[2] < b[0] || b[2] < a[0] || a[3] < b[1] || b[3] < a[1];
        for (k, place) in places.iter().enumerate() {
            assert!(place[0] >= 0 && place[2] <= 200, "{place:?}");
            assert!(taken.iter().chain(&places[..k]).all(|other| apart(place, other)), "{place:?} of {places:?}");
        }
    }
}
