//! `goalbench render`.

mod pictures;

use std::path::{Path, PathBuf};

use agents::{Agent, Mode};
use envs::GoalEnv;
use envs::render::Renderer;
use envs::rng::{Purpose, Rng, stream};
use reports::wording::counted_u64;

use super::flags::{name, whole};
use super::{Exit, ExitCode, print};
use crate::Registry;
use crate::error::HarnessError;
use crate::outputs;
use crate::run::policy::Policy;
use pictures::{Album, Frames};

#[derive(clap::Args)]
#[command(group(clap::ArgGroup::new("actor").required(true).args(["run", "env"])))]
pub(super) struct Args {
    /// Folder of a run (RESULTS/runs/.../seed-N): its student acts, as of its last evaluation
    run: Option<PathBuf>,
    /// Environment in which random actions are taken
    #[arg(long, value_name = "ID", value_parser = name)]
    env: Option<String>,
    /// Animated GIF to write; a file of this name is replaced
    #[arg(long, value_name = "FILE.gif", required_unless_present = "frames")]
    out: Option<PathBuf>,
    /// New or empty folder to write every picture into, as PNG
    #[arg(long, value_name = "DIR")]
    frames: Option<PathBuf>,
    /// Episodes to draw
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = whole::<u64>(1..=1000))]
    episodes: u64,
    /// Seed of starts, goals and random actions
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = whole::<u64>(..))]
    seed: u64,
    /// Width and height of the pictures, pixels
    #[arg(long, value_name = "N", default_value_t = 360, value_parser = whole::<u32>(1..=4096))]
    size: u32,
}

/// Hundredths of a second that a picture of the GIF stays: the environments' steps of 0.04 s.
const FRAME_TIME: u16 = 4;
/// How long the last picture of an episode stays.
const LAST_FRAME_TIME: u16 = 60;

/// Who chooses the actions.
enum Actor {
    Student(Box<dyn Agent>),
    Random(Box<Rng>),
}

pub(super) fn render(registry: &Registry, args: &Args) -> Exit {
    let (mut env, mut actor) = match (&args.run, &args.env) {
        (Some(folder), _) => trained(registry, folder)?,
        (None, Some(id)) => random(registry, id, args.seed)?,
        (None, None) => unreachable!("clap asks for one of them"),
    };
    let places = [("--frames", &args.frames), ("--out", &args.out)];
    for (option, place) in places.into_iter().filter_map(|(option, place)| Some((option, place.as_ref()?))) {
        match option {
            "--frames" => outputs::folder(option, place, &[])?,
            _ => outputs::file(option, place, &[])?,
        }
        args.run.as_ref().map_or(Ok(()), |run| outputs::outside_runs(option, place, run))?;
    }
    if let (Some(frames), Some(out)) = (&args.frames, &args.out) {
        outputs::apart(("--frames", frames), ("--out", out))?;
    }
    let renderer = Renderer::new(env.as_ref(), args.size, args.size)?;
    let pictures = args.episodes * (env.spec().horizon as u64 + 1);
    let mut film = Film { renderer, albums: albums(args, pictures)?, pictures: 0 };
    let mut rng = stream(args.seed, Purpose::Environment);
    let mut successes = 0;
    for _ in 0..args.episodes {
        successes += u64::from(episode(env.as_mut(), &mut actor, &mut rng, &mut film)?);
    }
    film.albums.into_iter().try_for_each(Album::finish)?;
    if let Some(path) = &args.out {
        print(&format!("{}\n", path.display()));
    }
    print(&format!(
        "{} of {}, {successes} of them successful\n",
        counted_u64(film.pictures, "picture"),
        counted_u64(args.episodes, "episode")
    ));
    Ok(ExitCode::Success)
}

/// What the flags ask for, each place checked and ready.
fn albums(args: &Args, pictures: u64) -> Result<Vec<Box<dyn Album>>, HarnessError> {
    let mut albums: Vec<Box<dyn Album>> = Vec::new();
    if let Some(path) = &args.out {
        albums.push(pictures::animation(path, args.size)?);
    }
    if let Some(folder) = &args.frames {
        albums.push(Box::new(Frames::begin(folder, pictures)?));
    }
    Ok(albums)
}

/// Draws an environment into albums.
struct Film {
    renderer: Renderer,
    albums: Vec<Box<dyn Album>>,
    /// Drawn so far.
    pictures: u64,
}

impl Film {
    fn shoot(&mut self, env: &dyn GoalEnv, hundredths: u16) -> Result<(), HarnessError> {
        let image = self.renderer.frame(env)?;
        self.pictures += 1;
        self.albums.iter_mut().try_for_each(|album| album.add(&image, hundredths))
    }
}

/// Environment and student of a run.
fn trained(registry: &Registry, folder: &Path) -> Result<(Box<dyn GoalEnv>, Actor), HarnessError> {
    let policy = Policy::read(registry, folder)?;
    let env = policy.environment(registry)?;
    let student = policy.student(env.spec())?;
    Ok((env, Actor::Student(student)))
}

fn random(registry: &Registry, id: &str, seed: u64) -> Result<(Box<dyn GoalEnv>, Actor), HarnessError> {
    let Some(entry) = registry.environment(id) else {
        let accepted = registry.environments().iter().map(envs::Environment::id);
        return Err(HarnessError::unknown("--env: ", "environment", id, accepted));
    };
    let env = entry
        .make(&envs::EnvOptions::default())
        .map_err(HarnessError::unusable(id, "make this environment"))?;
    Ok((env, Actor::Random(Box::new(stream(seed, Purpose::Exploration)))))
}

/// Plays one episode and draws every step. Gives its success.
fn episode(
    env: &mut dyn GoalEnv,
    actor: &mut Actor,
    rng: &mut Rng,
    film: &mut Film,
) -> Result<bool, HarnessError> {
    let (id, steps) = (env.spec().id, env.spec().horizon);
    let mut action = vec![0.0; env.spec().action];
    env.reset(rng).map_err(HarnessError::unusable(id, "begin an episode"))?;
    film.renderer.begin_episode();
    film.shoot(env, FRAME_TIME)?;
    for step in 1..=steps {
        match actor {
            Actor::Student(agent) => agent
                .act(env.observation(), env.goal(), Mode::Greedy, &mut action)
                .map_err(HarnessError::unusable(id, "choose an action"))?,
            Actor::Random(rng) => action.fill_with(|| envs::rng::uniform(rng, -1.0, 1.0)),
        }
        env.step(&action).map_err(HarnessError::unusable(id, "take a step"))?;
        film.shoot(env, if step < steps { FRAME_TIME } else { LAST_FRAME_TIME })?;
    }
    Ok(env.success(&env.observation().achieved, env.goal()))
}
