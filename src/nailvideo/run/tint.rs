//! How far light alone takes a photodiode's value along: glare, and shadows that colour the light.
//!
//! In: ln green/red and ln blue/red of the light at each photodiode over the video. Blood moves both along a line,
//! whatever the brightness; white that is added, and light of another colour, move blue by more than that. Out: where a
//! photodiode leaves its own line for half a second and more, by how much its value may be off. Each has a line of its
//! own, as zones of the nail may. Not determined: a colour of light that moves both as blood does, and light that lasts
//! over the whole video.

use crate::median::{ends, median_of};
use crate::nailvideo::options::Light;
use crate::nailvideo::press::noise_sd;

/// Frames on each side that are averaged, by their median: what lasts shorter is noise.
const AROUND: usize = 7;
/// Change of ln blue/red with that of ln green/red, as blood may have it (measured: 0.6 to 0.8 of photodiodes that
/// change much, phantoms, of colours as encoded and of light; real nails, by what `phantom` knows of their colours,
/// have 0.5 to 0.95); shadows that were tried have 1.8 and 2.
const BLOOD: [f64; 2] = [0.3, 1.0];
/// Off its line by so much, of 100 ln, is light (measured on 16 phantoms of 190 px without any: 2.8 at most; glare of
/// 15 % takes it to 7.5 where the value is off by 25. As encoded, 1.8 times less, soft shadows take it to 3.3 and more
/// where the value is off by 4), ..
const LEAST: f64 = 4.6;
/// .. and by so many times the noise of a frame, and the largest error that lasts (measured as encoded: a dark, noisy
/// film 1.9 times the noise; nails of 45 px, whose errors last, are 1.6 to 2.5 of 100 ln off their line).
const LEAST_SDS: f64 = 3.0;
/// A value is off by so many times as much (measured as encoded, the largest of each: glare 1.7 to 2.6, shadows 0.8 to
/// 1.5; of light, glare of 15 % 3.3, where 2 % of the values are beyond 3 standard errors that hold this).
const OFF_BY: f64 = 2.0;

/// A photodiode's colour in each frame.
#[derive(Debug)]
pub(super) struct Ratios {
    /// ln green/red and ln blue/red, times 100; NaN where the photodiode is missing.
    pub(super) green: Vec<f64>,
    pub(super) blue: Vec<f64>,
    /// The largest error of its value that lasts over frames, SD, of 100 ln.
    pub(super) steady_sd: f64,
}

/// By how much light takes each photodiode's value along, of 100 ln: zeros where it is not seen to. `enlarged` is what
/// compression multiplies noise by, `is_of_skin` whether what all have in common is taken off the values.
pub(super) fn tints(all: &[Ratios], enlarged: f64, is_of_skin: bool) -> Vec<Vec<f64>> {
    let mut off: Vec<Vec<f64>> = all.iter().map(off_line).collect();
    if is_of_skin {
        for row in 0..off.first().map_or(0, Vec::len) {
            let common = median_of(off.iter().map(|one| one[row]).filter(|one| one.is_finite())).unwrap_or(0.0);
            off.iter_mut().for_each(|one| one[row] -= common);
        }
    }
    let of = |(off, ratios): (&Vec<f64>, &Ratios)| {
        lasting(off, LEAST * enlarged, ratios.steady_sd).unwrap_or_else(|| vec![0.0; off.len()])
    };
    off.iter().zip(all).map(of).collect()
}

/// What to say of photodiodes that light takes along; `named` are names and, in the unit of the table of values, by how
/// much.
pub(super) fn tinted<'a>(named: impl Iterator<Item = (&'a str, &'a [f64])>, light: Light) -> Option<String> {
    let (decimals, unit) = match light {
        Light::Red => (1, "of 100 ln (green / red)"),
        Light::Skin => (1, "of 100 ln (green / skin)"),
        Light::None => (4, "of green light, full scale being 1"),
    };
    let most = |tint: &[f64]| tint.iter().fold(0.0, |most, by| f64::max(most, by.abs()));
    let all: Vec<String> = named
        .filter(|(_, tint)| most(tint) > 0.0)
        .map(|(name, tint)| format!("{name} ({:.decimals$})", most(tint)))
        .collect();
    (!all.is_empty()).then(|| {
        format!(
            "glare or a shadow that colours the light goes over {}: blue changes there by more than blood changes it, \
             and values may be off by as much as in brackets, {unit}. Their standard errors hold that. Turn lamp or \
             hand until nothing shines on the nail, keep shadows off it, fix the white balance, and film again",
            all.join(", ")
        )
    })
}

/// Blue less what of it goes with green as blood's does.
fn off_line(Ratios { green, blue, .. }: &Ratios) -> Vec<f64> {
    let about_middle = |values: &[f64]| -> Vec<f64> {
        let middle = median_of(values.iter().copied().filter(|one| one.is_finite())).unwrap_or(f64::NAN);
        values.iter().map(|one| one - middle).collect()
    };
    let [green, blue] = [green, blue].map(|values| about_middle(values));
    let (mut products, mut squares) = (0.0, 0.0);
    for (green, blue) in green.iter().zip(&blue).filter(|(green, blue)| (*green + *blue).is_finite()) {
        products += green * blue;
        squares += green * green;
    }
    let line = if squares > 0.0 { products / squares } else { BLOOD[0] }.clamp(BLOOD[0], BLOOD[1]);
    green.iter().zip(&blue).map(|(green, blue)| blue - line * green).collect()
}

/// By how much the value may be off in each frame, where that is at least `least` and more than noise.
fn lasting(off: &[f64], least: f64, steady_sd: f64) -> Option<Vec<f64>> {
    let middle_about = |k: usize| {
        let around = &off[k.saturating_sub(AROUND)..(k + AROUND + 1).min(off.len())];
        let known: Vec<f64> = around.iter().copied().filter(|one| one.is_finite()).collect();
        if known.len() > AROUND { median_of(known) } else { None }
    };
    let smooth: Vec<Option<f64>> = (0..off.len()).map(middle_about).collect();
    let rest = median_of(smooth.iter().copied().flatten())?;
    let smooth: Vec<f64> = smooth.into_iter().map(|one| one.map_or(0.0, |one| one - rest)).collect();
    let [low, high] = ends(smooth.iter().copied());
    let limit = least.max(LEAST_SDS * noise_sd(off)?.max(steady_sd));
    (high.max(-low) > limit).then(|| smooth.iter().map(|by| OFF_BY * by).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trial::normals;

    /// Two photodiodes under a press, over the first of which light moves green by `light` and blue by twice as much.
    fn pressed(light: f64) -> Vec<Ratios> {
        let mut normal = normals(3);
        let press = |k: usize| if (100..200).contains(&k) { 20.0 } else { 0.0 };
        let of = |k: usize, light: f64| light * (-(k as f64 - 240.0).powi(2) / 800.0).exp();
        let mut one = |light: f64, line: f64| {
            let green: Vec<f64> = (0..300).map(|k| press(k) + of(k, light) + 0.2 * normal()).collect();
            let blue = (0..300).map(|k| line * press(k) + 2.0 * of(k, light) + 0.3 * normal()).collect();
            Ratios { green, blue, steady_sd: 0.3 }
        };
        vec![one(light, 0.7), one(0.0, 0.5)]
    }

    #[test]
    fn light_is_known_from_blood_by_blue() {
        assert!(tints(&pressed(0.0), 1.0, false).iter().flatten().all(|by| *by == 0.0));
        let tints = tints(&pressed(9.2), 1.0, false);
        assert!(tints[0][240] >= 9.2 && tints[0][150].abs() <= 2.8, "{} {}", tints[0][240], tints[0][150]);
        assert!(tints[1].iter().all(|by| *by == 0.0));
        let said = |light: Light, part: f64| {
            let of: Vec<Vec<f64>> = tints.iter().map(|tint| tint.iter().map(|by| part * by).collect()).collect();
            tinted(["P1", "P2"].into_iter().zip(of.iter().map(Vec::as_slice)), light).expect("a warning")
        };
        // As of a green of 0.4: percent of it.
        let none = said(Light::None, 0.004);
        assert!(none.contains("goes over P1 (0.0") && !none.contains("(0.0000)"), "{none}");
        assert!(none.contains("of green light, full scale being 1") && !none.contains(" ln "), "{none}");
        assert!(said(Light::Skin, 1.0).contains("of 100 ln (green / skin)"));
        let said = said(Light::Red, 1.0);
        assert!(said.contains("goes over P1 (") && !said.contains("P2"), "{said}");
    }

    #[test]
    fn what_noise_and_compression_leave_is_no_light() {
        assert!(tints(&pressed(9.2), 5.0, false).iter().flatten().all(|by| *by == 0.0));
        let mut noisy = pressed(0.0);
        let mut normal = normals(4);
        noisy.iter_mut().flat_map(|one| &mut one.blue).for_each(|blue| *blue += 4.0 * normal());
        assert!(tints(&noisy, 1.0, false).iter().flatten().all(|by| *by == 0.0));
        let mut unsteady = pressed(9.2);
        unsteady.iter_mut().for_each(|one| one.steady_sd = 5.5);
        assert!(tints(&unsteady, 1.0, false).iter().flatten().all(|by| *by == 0.0));
        let missing = Ratios { green: vec![f64::NAN; 40], blue: vec![f64::NAN; 40], steady_sd: 0.0 };
        assert!(tints(&[missing], 1.0, false).iter().flatten().all(|by| *by == 0.0));
    }
}
