//! Drawing in turns.

use pointstage_engine::stage::Stage;
use pointstage_scene::Camera;

use super::lane::{Lane, request};
use super::{BenchArguments, Stand};
use crate::cli::drawing::Cost;
use crate::cli::measuring::times::{draw, millis};
use crate::cli::{Globals, Outcome};

/// A picture that takes longer warms nothing up that would show, ms.
const SLOW_MS: f64 = 1000.0;

/// Draws every lane's pictures, round by round. In each round a lane draws every `rounds`th picture of the path, so that the
/// whole path is in each round.
pub(super) fn measure(
    globals: &Globals,
    arguments: &BenchArguments,
    (stands, paths): (&[Stand], &[Vec<Camera>]),
    lanes: &mut [Lane<'_>],
) -> Outcome {
    // One a scene: what is prepared and uploaded for it stays while the others draw.
    let mut stages = stands
        .iter()
        .map(|_| Ok(Stage::new(globals.stage_options())?))
        .collect::<Outcome<Vec<_>>>()?;
    let mut last: Vec<Option<usize>> = vec![None; stands.len()];
    let rounds = arguments.rounds.min(arguments.frames);
    for round in 0..rounds {
        tracing::info!("round {} of {rounds}", round + 1);
        for number in order(lanes.len(), round) {
            let lane = &mut lanes[number];
            let is_spent = lane.spent_secs() > f64::from(arguments.budget);
            if lane.unsuitable.is_some() || (is_spent && !lane.costs.is_empty()) {
                continue;
            }
            let (stand, stage) = (&stands[lane.stand], &mut stages[lane.stand]);
            let way = &paths[lane.stand];
            // The first picture of all is the first image once more: preparation is no switch.
            let before = last[lane.stand].replace(number);
            let is_switch = round > 0 && before.is_some_and(|before| before != number);
            let turn = Turn {
                arguments,
                stand,
                way,
                round,
                rounds,
                is_switch,
            };
            turn.draw(stage, lane)?;
        }
    }
    Ok(())
}

/// Forwards and backwards in turns: what drifts evenly then weighs the same on all.
fn order(count: usize, round: u32) -> Vec<usize> {
    let mut order: Vec<usize> = (0..count).collect();
    if !round.is_multiple_of(2) {
        order.reverse();
    }
    order
}

/// One lane's part of a round.
struct Turn<'a> {
    arguments: &'a BenchArguments,
    stand: &'a Stand,
    way: &'a [Camera],
    round: u32,
    rounds: u32,
    is_switch: bool,
}

impl Turn<'_> {
    fn draw(&self, stage: &mut Stage, lane: &mut Lane<'_>) -> Outcome {
        let first = self.one(stage, lane, self.round as usize + self.way.len() / 2)?;
        let first_ms = millis(first.wall);
        if self.is_switch {
            lane.switches_ms.push(first_ms);
        }
        if first_ms < SLOW_MS {
            for picture in 0..self.arguments.warm_up {
                self.one(stage, lane, picture as usize + self.way.len() / 3)?;
            }
        }
        let pictures = (self.round as usize..self.way.len()).step_by(self.rounds as usize);
        for picture in pictures {
            if !lane.costs.is_empty() && lane.spent_secs() > f64::from(self.arguments.budget) {
                break;
            }
            let cost = self.one(stage, lane, picture)?;
            lane.costs.push(cost);
        }
        Ok(())
    }

    /// Draws a picture of the way.
    fn one(&self, stage: &mut Stage, lane: &mut Lane<'_>, picture: usize) -> Outcome<Cost> {
        let Some(camera) = self.way.get(picture % self.way.len().max(1)) else {
            return Ok(Cost::default());
        };
        let request = request(self.arguments, lane.entry, &self.stand.scene, *camera);
        let (result, cost) = draw(stage, &request)?;
        lane.note(&result.stats);
        Ok(cost)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_even_drift_weighs_the_same_on_all() {
        // The machine gets slower by one from picture to picture.
        let mut sums = [0_usize; 3];
        for round in 0..4 {
            for (slowness, lane) in order(3, round).into_iter().enumerate() {
                sums[lane] += slowness + 3 * round as usize;
            }
        }
        assert_eq!(sums, [sums[0]; 3]);
    }
}
