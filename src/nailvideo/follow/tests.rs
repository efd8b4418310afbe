use super::*;
use crate::nailvideo::scenes::{Scene, Shot};

/// A motion of up to 33 px of a nail of 192 px, 4.5 degrees and 3 %, with a tilt where asked.
fn motion(scene: &Scene, k: usize, tilt: f64) -> Affine {
    let t = k as f64;
    let middle = scene.frame_from_nail.of([0.0, 0.0]);
    let way = scene.frame_from_nail.0[0] / 96.0;
    let to = [middle[0] + 26.0 * way * (0.21 * t).sin(), middle[1] + 20.0 * way * (0.17 * t).sin()];
    let similar = Affine::similarity(middle, to, 0.0785 * (0.13 * t).sin(), 1.0 + 0.03 * (0.11 * t).sin());
    let [a, b, c, d, e, f] = similar.0;
    let squeeze = 1.0 - tilt * (0.5 - 0.5 * (0.19 * t).cos());
    // The nail's length shrinks about its middle.
    let shift = |part: f64| part * (1.0 - squeeze) * middle[1];
    Affine([a, b * squeeze, c + shift(b), d, e * squeeze, f + shift(e)])
}

/// Root mean square of the errors over frames, the largest, the mean error along the nail at full blanching, and the
/// share of frames whose error is within one and two standard errors.
fn errors(scene: &Scene, frames: usize, shot: impl Fn(usize) -> Shot) -> ([f64; 2], [f64; 2]) {
    let first = scene.picture(&Shot::REST, 1);
    let mut follower = Follower::new(&first.frame(0, 0.0), 0, scene.frame_from_nail);
    let (mut all, mut within) = (Vec::new(), [0.0; 2]);
    for k in 1..frames {
        let shot = shot(k);
        let picture = scene.picture(&shot, 100 + k as u64);
        match follower.step(&picture.frame(k as u64, k as f64 / 30.0)) {
            Ok(place) => {
                let error = scene.apart(&place.motion, &shot.motion);
                all.push(error);
                within[0] += f64::from(u8::from(error <= place.se_px));
                within[1] += f64::from(u8::from(error <= 2.0 * place.se_px));
                if std::env::var_os("SHOW").is_some() {
                    println!("{k} {error:.3} se {:.3} ncc {:.3} in {:.3}", place.se_px, place.ncc, place.inliers);
                }
            }
            Err(lost) => println!("{k}: {}", lost.name()),
        }
    }
    let count = all.len() as f64;
    assert!(all.len() * 10 >= frames * 9, "{} of {frames} frames", all.len());
    let rms = (all.iter().map(|e| e * e).sum::<f64>() / count).sqrt();
    ([rms, all.iter().copied().fold(0.0, f64::max)], within.map(|n| n / count))
}

#[test]
fn the_nail_is_followed_within_the_bars() {
    let scene = Scene::new(192.0, 1);
    let press = |k: usize| 0.5 - 0.5 * (0.3 * k as f64).cos();
    let still = |_: usize| Shot::REST;
    let moved = |k: usize| Shot { motion: motion(&scene, k, 0.0), ..Shot::REST };
    let pressed = |k: usize| Shot { blanched: press(k), ..moved(k) };
    let hidden = |k: usize| Shot {
        motion: motion(&scene, k, 0.03),
        rod: Some([1.2 - 0.4 * press(k), 0.12]),
        light: [1.0, 0.24 * (0.2 * k as f64).sin()],
        ..pressed(k)
    };
    // Bars: section 2.6 of the design.
    type Shots<'a> = &'a dyn Fn(usize) -> Shot;
    let cases: [(&str, Shots<'_>, f64); 4] = [
        ("still", &still, 0.08),
        ("moved", &moved, 0.11),
        ("press", &pressed, 0.20),
        ("rod, light, tilt", &hidden, 0.40),
    ];
    for (name, shot, bar) in cases {
        let ([rms, most], within) = errors(&scene, 20, shot);
        println!("{name}: RMS {rms:.3} px, largest {most:.3}, within {within:?}");
        assert!(rms <= bar, "{name}: {rms}");
    }
}

#[test]
fn a_small_nail_is_followed() {
    let scene = Scene::new(40.0, 2);
    let shot =
        |k: usize| Shot { motion: motion(&scene, k, 0.0), blanched: 0.5 - 0.5 * (0.3 * k as f64).cos(), ..Shot::REST };
    let ([rms, most], within) = errors(&scene, 20, shot);
    println!("40 px: RMS {rms:.3} px, largest {most:.3}, within {within:?}");
    assert!(rms <= 0.25, "{rms}");
}

#[test]
fn another_nail_in_the_same_place_is_not_followed() {
    let (scene, other) = (Scene::new(192.0, 1), Scene::new(192.0, 9));
    let first = scene.picture(&Shot::REST, 1);
    let mut follower = Follower::new(&first.frame(0, 0.0), 0, scene.frame_from_nail);
    let is_there = |k: u64| !(4..12).contains(&k);
    let mut back = Vec::new();
    for k in 1..24 {
        let picture = if is_there(k) { &scene } else { &other }.picture(&Shot::REST, 100 + k);
        let place = follower.step(&picture.frame(k, k as f64 / 30.0));
        assert!(is_there(k) || place.is_err(), "{k}: {place:?}");
        back.extend((k >= 12 && place.is_ok()).then_some(k));
    }
    // Three frames confirm it.
    assert!(back.first().is_some_and(|&k| (14..=20).contains(&k)) && back.len() >= 4, "{back:?}");
}

#[test]
fn a_hand_that_leaves_is_lost() {
    let scene = Scene::new(192.0, 1);
    let first = scene.picture(&Shot::REST, 1);
    let mut follower = Follower::new(&first.frame(0, 0.0), 0, scene.frame_from_nail);
    let bare = scene.picture(&Shot { nail: false, ..Shot::REST }, 2);
    for k in 1..12 {
        let place = follower.step(&bare.frame(k, k as f64 / 30.0));
        assert!(place.is_err(), "{k}: {place:?}");
    }
}

#[test]
fn a_nail_that_was_seen_to_change_is_found_again() {
    let first = Scene::new(192.0, 1);
    let noisy = |noise: f64| {
        let mut scene = first.clone();
        scene.noise = noise;
        scene
    };
    let picture = first.picture(&Shot::REST, 1);
    let mut follower = Follower::new(&picture.frame(0, 0.0), 0, first.frame_from_nail);
    let mut step =
        |k: u64, scene: &Scene, shot: &Shot| follower.step(&scene.picture(shot, 100 + k).frame(k, k as f64 / 30.0));
    // Noise takes off the correlation what a press, a turn or an encoder would.
    let (mut noise, mut ncc) = (1.0, Vec::new());
    for k in 1..80 {
        ncc.push(step(k, &noisy(noise), &Shot::REST).expect("followed").ncc);
        if k > 15 && ncc[ncc.len() - 1] > 0.92 * ncc[0] {
            noise += 0.2;
        }
    }
    println!("noise {noise:.1}: correlation {:.3}, then {:.3}", ncc[0], ncc[78]);
    assert!(ncc[78] < 0.93 * ncc[0], "no change");
    for k in 80..84 {
        assert!(step(k, &noisy(noise), &Shot { nail: false, ..Shot::REST }).is_err());
    }
    let back = (84..94).find(|&k| step(k, &noisy(noise), &Shot::REST).is_ok());
    // Three frames confirm it.
    assert!(back.is_some_and(|k| k <= 88), "{back:?}");
}
