//! HER-IID: no teacher. Every episode keeps the goal that the environment drew itself (Andrychowicz et al.,
//! "Hindsight Experience Replay", NeurIPS 2017). The baseline that a curriculum has to beat.
//!
//! # Deviations and choices
//! - The goal comes from the environment's own joint draw of start and goal at the reset, as in Baselines'
//!   HER, so the teacher's stream is not used. VDS's code, run without an ensemble, draws goals from an
//!   instance of its own.
//! - TEACH runs HER-IID with "official code" that it does not name. Here the student is the same for all
//!   methods.

use looks::colours::BLACK;
use looks::{Dash, Look, Marker};
use schemars::{JsonSchema, Schema};
use serde::{Deserialize, Serialize};

use crate::config::schema_of;
use crate::curriculum::{Lesson, Proposal, Setting};
use crate::error::CurriculumError;
use crate::method::Method;

/// HER-IID has no options.
#[derive(Clone, Debug, Default, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct HerIidConfig {}

/// The environment's own goals.
pub struct HerIid;

impl Method for HerIid {
    type Config = HerIidConfig;
    type State = ();
    const ID: &'static str = "her-iid";
    const TITLE: &'static str = "HER-IID";
    const LOOK: Option<Look> = Some(Look::new(BLACK, Dash::Dotted, Marker::Cross));
    const SOURCE: &'static str = "Andrychowicz et al., Hindsight Experience Replay, NeurIPS 2017";
    const VERSION: &'static str = "1";
    const USES_POOL: bool = false;

    fn schema() -> Option<Schema> {
        Some(schema_of::<HerIidConfig>())
    }

    fn build(_config: HerIidConfig, _setting: &Setting) -> Result<Self, CurriculumError> {
        Ok(Self)
    }

    fn begin(&self, _setting: &Setting) -> Result<(), CurriculumError> {
        Ok(())
    }

    fn propose(&self, _state: &mut (), _lesson: &mut Lesson<'_>) -> Result<Proposal, CurriculumError> {
        Ok(Proposal::native())
    }
}
