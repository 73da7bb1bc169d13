//! HandReach: bring the five fingertips to given places; goals ask the thumb to meet one finger.

use mujoco_rs::wrappers::mj_model::MjtObj;
use serde_json::{Map, Value, json};

use super::Hand;
use crate::draws::Draws;
use crate::env::{Observation, Reward};
use crate::error::EnvError;
use crate::metric::{WithinDistance, norm};
use crate::mujoco::{Physics, Site, Snapshot, sub};
use crate::playback::{PlaybackError, RecordedWorld, Start};
use crate::scene::{GoalShape, Scene, Sphere};
use crate::world::World;
use crate::writer::Writer;

/// Distance in the 15 dimensions of all fingertips within which a goal counts as reached, metres.
const THRESHOLD: f64 = 0.01;
/// Where thumb and finger meet, from the palm.
const MEETING: [f64; 3] = [0.0, -0.09, 0.05];
/// Standard deviation of the meeting point, metres.
const SPREAD: f64 = 0.005;
/// Each of the two stops this much before the meeting point, metres.
const GAP: f64 = 0.005;
/// Share of goals that ask for the initial fingertips.
const AT_REST: f64 = 0.1;
/// Fore-, middle, ring, little finger and thumb.
const TIPS: [&str; 5] =
    ["robot0:S_fftip", "robot0:S_mftip", "robot0:S_rftip", "robot0:S_lftip", "robot0:S_thtip"];
/// Index of the thumb in [`TIPS`].
const THUMB: usize = 4;

/// Joint angles at the start of every episode, radians.
const INITIAL: [(&str, f64); 24] = [
    ("robot0:WRJ1", -0.165_143_397_504_643_27),
    ("robot0:WRJ0", -0.319_732_865_650_621_53),
    ("robot0:FFJ3", 0.143_405_125_465_574_35),
    ("robot0:FFJ2", 0.320_282_083_335_915_73),
    ("robot0:FFJ1", 0.712_605_360_772_791_7),
    ("robot0:FFJ0", 0.670_528_100_141_258_6),
    ("robot0:MFJ3", 0.000_246_444_303_701_037),
    ("robot0:MFJ2", 0.315_265_525_108_549_1),
    ("robot0:MFJ1", 0.765_980_031_372_984_2),
    ("robot0:MFJ0", 0.732_315_689_742_592_3),
    ("robot0:RFJ3", 0.000_385_207_000_073_781_14),
    ("robot0:RFJ2", 0.367_435_462_019_852_33),
    ("robot0:RFJ1", 0.711_951_409_500_857_6),
    ("robot0:RFJ0", 0.669_944_632_751_413_8),
    ("robot0:LFJ4", 0.052_544_225_803_389_1),
    ("robot0:LFJ3", -0.136_155_347_244_746_73),
    ("robot0:LFJ2", 0.398_720_304_334_330_03),
    ("robot0:LFJ1", 0.741_557_000_967_925_2),
    ("robot0:LFJ0", 0.704_096_378_652_974),
    ("robot0:THJ4", 0.003_673_823_825_070_126),
    ("robot0:THJ3", 0.550_629_143_602_869_5),
    ("robot0:THJ2", -0.014_515_151_997_119_306),
    ("robot0:THJ1", -0.001_522_922_356_448_541_4),
    ("robot0:THJ0", -0.789_488_302_160_062_2),
];

/// Sites that the reference's renderer moves to goals and fingertips.
const HIDDEN_SITES: [&str; 10] = [
    "target0", "target1", "target2", "target3", "target4", "finger0", "finger1", "finger2", "finger3",
    "finger4",
];
/// Their colours, finger by finger.
const COLOURS: [[f32; 3]; 5] =
    [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 1.0, 0.0], [1.0, 0.0, 1.0]];

/// The five fingertips, metres.
type Tips = [[f64; 3]; 5];

/// The world of HandReach. Positions are metres, angles radians, velocities per second.
pub(super) struct HandReach {
    hand: Hand,
    tips: [Site; 5],
    initial: Snapshot,
    /// Fingertips at the start.
    initial_tips: Tips,
    /// Position of the palm at the start.
    palm: [f64; 3],
}

impl HandReach {
    pub(super) fn new(id: &'static str, physics: Physics) -> Result<Self, EnvError> {
        let mut hand = Hand::new(id, "hand/reach.xml", physics)?;
        let [ff, mf, rf, lf, th] = TIPS.map(|name| hand.sim.site(name));
        let tips = [ff?, mf?, rf?, lf?, th?];
        let palm = hand.sim.id(MjtObj::mjOBJ_BODY, "robot0:palm")?;
        for (name, angle) in INITIAL {
            let joint = hand.sim.joint(name)?;
            hand.sim.data_mut().qpos_mut()[joint.qpos] = angle;
        }
        hand.sim.forward();
        hand.sim.check()?;
        let data = hand.sim.data();
        let initial_tips = std::array::from_fn(|i| tips[i].position(data));
        let (palm, initial) = (data.xpos()[palm], hand.sim.snapshot());
        Ok(Self { hand, tips, initial, initial_tips, palm })
    }

    fn tips_now(&self) -> Tips {
        std::array::from_fn(|i| self.tips[i].position(self.hand.sim.data()))
    }
}

/// The point [`GAP`] before `meeting`, coming from `tip`.
fn stop_before(meeting: [f64; 3], tip: [f64; 3]) -> [f64; 3] {
    let way = sub(meeting, tip);
    let length = norm(&way);
    std::array::from_fn(|i| meeting[i] - GAP * (way[i] / length))
}

impl World for HandReach {
    /// The start is always the same.
    fn start(&mut self, _draws: &mut Draws<'_>) -> Result<(), EnvError> {
        let sim = &mut self.hand.sim;
        sim.data_mut().reset();
        sim.restore(&self.initial);
        sim.forward();
        sim.check()
    }

    fn draw_goal(&self, draws: &mut Draws<'_>, goal: &mut [f64]) {
        let finger = draws.index(THUMB);
        let shift: [f64; 3] = draws.normal(SPREAD);
        let meeting = std::array::from_fn(|i| self.palm[i] + MEETING[i] + shift[i]);
        let mut tips = self.initial_tips;
        for tip in [THUMB, finger] {
            tips[tip] = stop_before(meeting, self.initial_tips[tip]);
        }
        let [at_rest] = draws.uniform([0.0], [1.0]);
        if at_rest < AT_REST {
            tips = self.initial_tips;
        }
        goal.copy_from_slice(tips.as_flattened());
    }

    fn advance(&mut self, action: &[f64]) -> Result<(), EnvError> {
        self.hand.act(action);
        self.hand.sim.advance()
    }

    /// Joint positions 24, joint velocities 24, fingertips 15. After a step the fingertips lag one substep
    /// behind the joints, as in the reference.
    fn observe(&self, observation: &mut Observation) {
        let tips = self.tips_now();
        let mut state = Writer::new(&mut observation.state);
        self.hand.write_joints(&mut state);
        state.put(tips.as_flattened());
        observation.achieved.copy_from_slice(tips.as_flattened());
    }

    fn task(&self) -> &dyn Reward {
        &WithinDistance(THRESHOLD)
    }

    /// Small spheres where the fingertips should be, large faint ones where they are.
    fn scene(&self, goal: &[f64]) -> Option<Scene<'_>> {
        let goals = goal.chunks_exact(3).map(|tip| ([tip[0], tip[1], tip[2]], 0.005, 1.0));
        let tips = self.tips_now().into_iter().map(|tip| (tip, 0.01, 0.2));
        let colours = COLOURS.iter().chain(&COLOURS);
        let spheres = goals.chain(tips).zip(colours).map(|((centre, radius, opacity), &[r, g, b])| Sphere {
            centre,
            radius,
            rgba: [r, g, b, opacity],
        });
        Some(self.hand.scene(&HIDDEN_SITES, GoalShape::Spheres(spheres.collect())))
    }

    fn recorded(&mut self) -> Option<&mut dyn RecordedWorld> {
        Some(self)
    }
}

impl RecordedWorld for HandReach {
    fn constants(&self) -> Map<String, Value> {
        let own = json!({
            "reward_type": "sparse",
            "distance_threshold": THRESHOLD,
            "rotation_threshold": null,
            "relative_control": false,
            "initial_goal": self.initial_tips.as_flattened(),
            "palm_xpos": self.palm,
        });
        self.hand.sim.constants(&self.initial, own)
    }

    fn capture(&self) -> Start {
        self.hand.sim.capture()
    }

    fn restore(&mut self, state: &Start) -> Result<(), PlaybackError> {
        self.hand.sim.begin(state)
    }
}

#[cfg(test)]
mod tests {
    use super::stop_before;

    #[test]
    fn a_finger_stops_half_a_centimetre_before_the_meeting_point() {
        // Coming straight down on z from 1 m above.
        assert_eq!(stop_before([1.0, 2.0, 3.0], [1.0, 2.0, 4.0]), [1.0, 2.0, 3.005]);
    }
}
