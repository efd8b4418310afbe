//! Where names go: beside their markers, over no other marker and no other name, as far as there is room.

/// A box: left, top, right, bottom, pixels.
pub(super) type Box4 = [f64; 4];

/// How far above or below its marker a name may stand, in heights of it.
const STEPS: [f64; 4] = [0.0, 1.3, 2.6, 3.9];

/// The box of a name of `width` x `height` at a marker, that lies over the least of what is `taken`, within `size`.
pub(super) fn place(
    [x, y]: [f64; 2],
    radius: f64,
    (width, height): (f64, f64),
    size: (f64, f64),
    taken: &[Box4],
) -> Box4 {
    let candidates = STEPS.into_iter().flat_map(|step| {
        let (right, left) = (x + radius + 3.0, x - radius - 3.0 - width);
        let (above, below) = (y - radius - (1.0 + step) * height, y + radius + step * height);
        [(right, above), (right, below), (left, above), (left, below)]
    });
    let boxes = candidates.map(|(left, top)| {
        let (left, top) = (left.clamp(0.0, (size.0 - width).max(0.0)), top.clamp(0.0, (size.1 - height).max(0.0)));
        [left, top, left + width, top + height]
    });
    let covered = |one: &Box4| taken.iter().map(|other| overlap(one, other)).sum::<f64>();
    let mut best: Option<(f64, Box4)> = None;
    for one in boxes {
        let cost = covered(&one);
        if best.is_none_or(|(least, _)| cost < least) {
            best = Some((cost, one));
        }
    }
    best.map_or([x, y, x + width, y + height], |(_, one)| one)
}

fn overlap(one: &Box4, other: &Box4) -> f64 {
    let across = one[2].min(other[2]) - one[0].max(other[0]);
    let down = one[3].min(other[3]) - one[1].max(other[1]);
    across.max(0.0) * down.max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_near_markers_lie_apart_and_inside() {
        let markers = [[100.0, 50.0], [120.0, 50.0], [140.0, 52.0], [195.0, 55.0]];
        let mut taken: Vec<Box4> = markers.iter().map(|[x, y]| [x - 8.0, y - 8.0, x + 8.0, y + 8.0]).collect();
        for marker in markers {
            let label = place(marker, 8.0, (60.0, 14.0), (200.0, 150.0), &taken);
            assert!(taken.iter().all(|other| overlap(&label, other) == 0.0), "{label:?} over {taken:?}");
            assert!(label[0] >= 0.0 && label[1] >= 0.0 && label[2] <= 200.0 && label[3] <= 150.0);
            taken.push(label);
        }
    }
}
