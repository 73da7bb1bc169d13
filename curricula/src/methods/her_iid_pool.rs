//! HER-IID-pool: a goal drawn uniformly from the fixed pool. The control that separates "choosing well" from
//! "choosing from a fixed pool": it differs from a pool teacher in the choice alone.
//!
//! # Deviations and choices
//! - No paper has it. TEACH's HER-IID draws from the task space, not from the N goals that its teacher
//!   chooses from.
//! - Goals of HandManipulate* hold the place where the object settled at the start that they were drawn for.
//!   A goal of the pool keeps that place when it is set at another start, as with every teacher of the pool.
//!   In the rotation tasks the place does not count, but the student sees it in the goal; in the other tasks
//!   it is off by the spread of the starts.

use looks::colours::GREY;
use looks::{Dash, Look, Marker};
use schemars::{JsonSchema, Schema};
use serde::{Deserialize, Serialize};

use crate::config::schema_of;
use crate::curriculum::{Lesson, Proposal, Setting, TeacherSummary};
use crate::distribution::Distribution;
use crate::error::CurriculumError;
use crate::method::Method;

/// HER-IID-pool has no options; the pool's size is `pool.size`.
#[derive(Clone, Debug, Default, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct HerIidPoolConfig {}

/// Uniform over the pool.
pub struct HerIidPool {
    curriculum: Distribution,
}

impl Method for HerIidPool {
    type Config = HerIidPoolConfig;
    type State = ();
    const ID: &'static str = "her-iid-pool";
    const TITLE: &'static str = "HER-IID-pool";
    const LOOK: Option<Look> = Some(Look::new(GREY, Dash::Sparse, Marker::Wedge));
    const SOURCE: &'static str = "Control of this benchmark: HER-IID over a fixed pool of goals";
    const VERSION: &'static str = "1";
    const USES_POOL: bool = true;

    fn schema() -> Option<Schema> {
        Some(schema_of::<HerIidPoolConfig>())
    }

    fn build(_config: HerIidPoolConfig, setting: &Setting) -> Result<Self, CurriculumError> {
        Ok(Self { curriculum: Distribution::uniform(setting.pool.len()) })
    }

    fn begin(&self, _setting: &Setting) -> Result<(), CurriculumError> {
        Ok(())
    }

    fn propose(&self, _state: &mut (), lesson: &mut Lesson<'_>) -> Result<Proposal, CurriculumError> {
        Ok(Proposal::pool(self.curriculum.draw(lesson.rng)))
    }

    fn summary<'a>(&'a self, _state: &'a ()) -> TeacherSummary<'a> {
        self.curriculum.summary()
    }
}
