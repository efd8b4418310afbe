//! Units that are the same (under the same load): exchanging them takes an equilibrium to an equilibrium.
//!
//! Of all orders of their lumens the search looks at the growing one alone; the others are written down afterwards. So
//! `m` equal units take as many boxes as ways to share them out over their branches, not as many as branches to the
//! power of `m`.

use super::cell::Cell;
use super::network::Network;
use super::root::{MOST_EQUILIBRIA, Root};

/// For each unit the last unit before it that is the same.
pub(super) fn twins(network: &Network) -> Vec<Option<usize>> {
    (0..network.units.len()).map(|i| (0..i).rev().find(|&k| network.units[k] == network.units[i])).collect()
}

/// Looks only for states in which the same units stand in growing order: the others mirror them. False where there are
/// none.
pub(super) fn order_twins(cell: &mut Cell, twins: &[Option<usize>]) -> bool {
    for (i, twin) in twins.iter().enumerate() {
        if let Some(k) = *twin {
            cell.units[i].lo = cell.units[i].lo.max(cell.units[k].lo);
        }
    }
    for (i, twin) in twins.iter().enumerate().rev() {
        if let Some(k) = *twin {
            cell.units[k].hi = cell.units[k].hi.min(cell.units[i].hi);
        }
    }
    cell.units.iter().all(|range| range.lo <= range.hi)
}

/// The equilibria with all orders of what stands on the same units; nothing where they are too many.
pub(super) fn mirrored(roots: Vec<Root>, twins: &[Option<usize>]) -> Option<Vec<Root>> {
    let mut classes: Vec<Vec<usize>> = Vec::new();
    for (i, twin) in twins.iter().enumerate() {
        match twin.and_then(|k| classes.iter_mut().find(|class| class.contains(&k))) {
            Some(class) => class.push(i),
            None => classes.push(vec![i]),
        }
    }
    let mut all = Vec::new();
    for mut root in roots {
        for class in &classes {
            let mut lumens: Vec<f64> = class.iter().map(|&i| root.units[i]).collect();
            lumens.sort_by(f64::total_cmp);
            class.iter().zip(lumens).for_each(|(&i, lumen)| root.units[i] = lumen);
        }
        let mut orders = vec![root];
        for class in &classes {
            let mut at = 0;
            while at < orders.len() {
                let mut next = orders[at].clone();
                if next_order(&mut next.units, class) {
                    orders.insert(at + 1, next);
                }
                at += 1;
                if all.len() + orders.len() > MOST_EQUILIBRIA {
                    return None;
                }
            }
        }
        all.extend(orders);
    }
    Some(all)
}

/// The next order of the values at these places, the first being the growing one; false after the last.
fn next_order(values: &mut [f64], places: &[usize]) -> bool {
    let Some(k) = (1..places.len()).rev().find(|&k| values[places[k - 1]] < values[places[k]]) else { return false };
    let pivot = values[places[k - 1]];
    let other = (k..places.len()).rev().find(|&m| values[places[m]] > pivot).expect("the one found above");
    values.swap(places[k - 1], places[other]);
    let (mut a, mut b) = (k, places.len() - 1);
    while a < b {
        values.swap(places[a], places[b]);
        (a, b) = (a + 1, b - 1);
    }
    true
}
