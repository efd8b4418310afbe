//! The pointer against scripts of forces.

mod behaviour;
mod exact;
mod faults;

use super::{Config, Event, Pointer, What};

/// Samples a second.
const RATE_HZ: f64 = 100.0;

/// A pointer, its clock and its events.
struct Bench {
    pointer: Pointer,
    events: Vec<Event>,
    samples: u32,
    /// Added to the time of all samples, s.
    shift_s: f64,
}

impl Bench {
    fn new(config: Config) -> Self {
        config.check().unwrap();
        Self { pointer: Pointer::new(config), events: Vec::new(), samples: 0, shift_s: 0.0 }
    }

    fn t_s(&self) -> f64 {
        f64::from(self.samples) / RATE_HZ + self.shift_s
    }

    /// One sample of shear and *pressing*, newtons.
    fn one(&mut self, [fx_n, fy_n, pressing_n]: [f64; 3], bend_deg: Option<f64>, valid: bool) {
        let (t_s, events) = (self.t_s(), &mut self.events);
        self.samples += 1;
        self.pointer.sample(t_s, fx_n, fy_n, -pressing_n, bend_deg, valid, &mut |event| events.push(event));
    }

    /// The same force for so long.
    fn hold(&mut self, seconds: f64, force_n: [f64; 3]) -> &mut Self {
        for _ in 0..(seconds * RATE_HZ).round() as u32 {
            self.one(force_n, None, true);
        }
        self
    }

    /// From one force to another.
    fn ramp(&mut self, seconds: f64, from_n: [f64; 3], to_n: [f64; 3]) -> &mut Self {
        let steps = (seconds * RATE_HZ).round();
        for step in 1..=steps as u32 {
            let part = f64::from(step) / steps;
            self.one(std::array::from_fn(|axis| from_n[axis] + part * (to_n[axis] - from_n[axis])), None, true);
        }
        self
    }

    fn bend(&mut self, seconds: f64, force_n: [f64; 3], bend_deg: f64) -> &mut Self {
        for _ in 0..(seconds * RATE_HZ).round() as u32 {
            self.one(force_n, Some(bend_deg), true);
        }
        self
    }

    /// The sum of the moves.
    fn at(&self) -> [i64; 2] {
        self.events.iter().fold([0; 2], |[x, y], event| match event.what {
            What::Move { dx, dy } => [x + i64::from(dx), y + i64::from(dy)],
            _ => [x, y],
        })
    }

    /// When the button went down and up.
    fn turns(&self) -> Vec<(f64, bool)> {
        let turns = self.events.iter().filter_map(|event| match event.what {
            What::Button { down, .. } => Some((event.t_s, down)),
            _ => None,
        });
        turns.collect()
    }

    /// Whether it went down or up, in order.
    fn downs(&self) -> Vec<bool> {
        self.turns().into_iter().map(|(_, down)| down).collect()
    }

    /// The events of a word.
    fn count(&self, word: &str) -> usize {
        self.events.iter().filter(|event| serde_json::to_value(event).unwrap()["event"] == word).count()
    }
}

/// A finger in the air.
const AIR: [f64; 3] = [0.0; 3];
/// One that rests on the desk.
const REST: [f64; 3] = [0.0, 0.0, 0.9];
/// One that pushes to the right and away.
const PUSH: [f64; 3] = [0.5, 0.2, 0.9];
/// One that clicks, with as much shear as friction may hold.
const CLICK: [f64; 3] = [1.0, -1.0, 2.5];
