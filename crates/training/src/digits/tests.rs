//! What the weights that the library comes with are worth, on drawn characters that they were not made from. The real
//! displays are among the library's own tests (`tests/digits.rs`).

use lunula::clock::SURE;
use lunula::clock::training::{Net, PARTS, Trace};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::fit::walk_back;
use super::{Faces, Kind, LEVELS, judge, samples};

/// Least share of clean digits that are read.
const LEAST_READ: f64 = 0.9;
/// Most of what is no digit that is taken for one.
const MOST_TAKEN: f64 = 0.03;
/// Most that a promised probability is off.
const OFF: f64 = 0.02;

/// The place of [`SURE`] among [`LEVELS`].
fn sure() -> usize {
    LEVELS.iter().position(|level| *level == SURE).unwrap()
}

#[test]
fn displays_that_nothing_was_trained_on_are_read_or_left_out() {
    // Seven segments alone: typefaces that are held out do not come along.
    let faces = Faces { families: vec![], ..Faces::load(None, true).unwrap() };
    let clean = judge(Net::shipped(), &faces, Kind::Clean, 0, 1500);
    assert_eq!(clean.wrong[sure()], 0);
    assert!(clean.right[sure()] as f64 >= LEAST_READ * clean.count as f64, "{clean:?}");
    let others = judge(Net::shipped(), &faces, Kind::Others, 0, 1500);
    assert!(others.wrong[sure()] as f64 <= MOST_TAKEN * others.count as f64, "{others:?}");
}

#[test]
fn the_phantoms_typefaces_are_read() {
    let faces = Faces { displays: vec![], families: Faces::load(None, false).unwrap().families };
    let clean = judge(Net::shipped(), &faces, Kind::Clean, 0, 1500);
    assert_eq!(clean.wrong[sure()], 0);
    assert!(clean.right[sure()] as f64 >= LEAST_READ * clean.count as f64, "{clean:?}");
}

#[test]
fn confidences_are_kept() {
    let faces = Faces { families: vec![], ..Faces::load(None, true).unwrap() };
    let any = judge(Net::shipped(), &faces, Kind::Any, 0, 4000);
    let [answered, right] = any.answered;
    let (promised, kept) = (any.promised / answered as f64, right as f64 / answered as f64);
    assert!((promised - kept).abs() <= OFF, "promised {promised:.4}, kept {kept:.4}");
}

#[test]
fn the_gradient_is_the_loss_slope() {
    let faces = Faces::load(None, false).unwrap();
    let count: usize = PARTS.iter().sum();
    let sample = samples(&faces, Kind::Any, 1, &mut ChaCha8Rng::seed_from_u64(5)).swap_remove(0);
    // Weights without a pattern: those that come along leave no loss to speak of.
    let net = Net { weights: (0..count).map(|k| ((k * 7919 % 1009) as f32 / 1009.0 - 0.47) * 0.2).collect() };
    let mut gradient = vec![0.0; count];
    let loss = |net: &Net| f64::from(walk_back(net, &sample, &mut Trace::default(), &mut vec![0.0; count]));
    walk_back(&net, &sample, &mut Trace::default(), &mut gradient);
    let mut from = 0;
    for part in PARTS {
        // The steepest weight of each part.
        let k = (from..from + part).max_by(|a, b| gradient[*a].abs().total_cmp(&gradient[*b].abs())).unwrap();
        let moved = |by: f32| {
            let mut other = net.clone();
            other.weights[k] += by;
            loss(&other)
        };
        let slope = (moved(2e-3) - moved(-2e-3)) / 4e-3;
        assert!((slope - f64::from(gradient[k])).abs() <= 0.02 * slope.abs() + 1e-3, "{k}: {slope} {}", gradient[k]);
        from += part;
    }
}

#[test]
fn written_weights_are_read_back() {
    let net = Net::parse(&super::text(Net::shipped())).unwrap();
    assert_eq!(net.weights, Net::shipped().weights);
}
