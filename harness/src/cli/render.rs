//! `goalbench render`.

use std::fs::{self, File};
use std::io::BufWriter;
use std::path::{Path, PathBuf};

use agents::{Agent, Mode};
use envs::GoalEnv;
use envs::render::{Image, Renderer};
use envs::rng::{Purpose, Rng, stream};

use super::flags::count_in;
use super::{Exit, ExitCode, print};
use crate::Registry;
use crate::error::HarnessError;
use crate::files::new_file;
use crate::outputs;
use crate::run::policy::Policy;

#[derive(clap::Args)]
#[command(group(clap::ArgGroup::new("actor").required(true).args(["run", "env"])))]
pub(super) struct Args {
    /// Folder of a run (RESULTS/runs/.../seed-N): its student acts, as of its last evaluation
    run: Option<PathBuf>,
    /// Environment in which random actions are taken
    #[arg(long, value_name = "ID")]
    env: Option<String>,
    /// Animated GIF to write
    #[arg(long, value_name = "FILE.gif", required_unless_present = "frames")]
    out: Option<PathBuf>,
    /// Folder to write every picture into, as PNG
    #[arg(long, value_name = "DIR")]
    frames: Option<PathBuf>,
    /// Episodes to draw
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = count_in(1..=1000))]
    episodes: u64,
    /// Seed of starts, goals and random actions
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u64,
    /// Width and height of the pictures, pixels
    #[arg(long, value_name = "N", default_value_t = 360)]
    size: u32,
}

/// Hundredths of a second that a picture of the GIF stays: the environments' steps of 0.04 s.
const FRAME_TIME: u16 = 4;
/// How long the last picture of an episode stays.
const LAST_FRAME_TIME: u16 = 60;
/// Speed of the GIF's colour reduction, 1 (best) to 30.
const GIF_SPEED: i32 = 10;

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
    if let Some(folder) = &args.frames {
        outputs::folder("--frames", folder, &[])?;
    }
    if let Some(path) = &args.out {
        outputs::file("--out", path, &[])?;
    }
    let mut renderer = Renderer::new(env.as_ref(), args.size, args.size)?;
    let mut frames: Vec<(Image, u16)> = Vec::new();
    let mut rng = stream(args.seed, Purpose::Environment);
    let mut successes = 0;
    for _ in 0..args.episodes {
        successes += u64::from(episode(env.as_mut(), &mut actor, &mut rng, &mut renderer, &mut frames)?);
    }
    if let Some(folder) = &args.frames {
        write_frames(folder, &frames)?;
    }
    if let Some(path) = &args.out {
        write_gif(path, &frames)?;
        print(&format!("{}\n", path.display()));
    }
    print(&format!(
        "{} pictures of {} episodes, {successes} of them successful\n",
        frames.len(),
        args.episodes
    ));
    Ok(ExitCode::Success)
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
    renderer: &mut Renderer,
    frames: &mut Vec<(Image, u16)>,
) -> Result<bool, HarnessError> {
    let id = env.spec().id;
    let mut action = vec![0.0; env.spec().action];
    env.reset(rng).map_err(HarnessError::unusable(id, "begin an episode"))?;
    renderer.begin_episode();
    frames.push((renderer.frame(env)?, FRAME_TIME));
    for _ in 0..env.spec().horizon {
        match actor {
            Actor::Student(agent) => agent
                .act(env.observation(), env.goal(), Mode::Greedy, &mut action)
                .map_err(HarnessError::unusable(id, "choose an action"))?,
            Actor::Random(rng) => action.fill_with(|| envs::rng::uniform(rng, -1.0, 1.0)),
        }
        env.step(&action).map_err(HarnessError::unusable(id, "take a step"))?;
        frames.push((renderer.frame(env)?, FRAME_TIME));
    }
    if let Some((_, time)) = frames.last_mut() {
        *time = LAST_FRAME_TIME;
    }
    Ok(env.success(&env.observation().achieved, env.goal()))
}

fn write_frames(folder: &Path, frames: &[(Image, u16)]) -> Result<(), HarnessError> {
    fs::create_dir_all(folder).map_err(HarnessError::io(folder, "create this folder"))?;
    for (index, (image, _)) in frames.iter().enumerate() {
        let path = folder.join(format!("frame-{index:04}.png"));
        guard::fresh::write(&path, &image.to_png()?).map_err(HarnessError::io(&path, "write this file"))?;
    }
    Ok(())
}

/// Writes the GIF, whole or not at all.
fn write_gif(path: &Path, frames: &[(Image, u16)]) -> Result<(), HarnessError> {
    let folder = outputs::folder_of(path);
    fs::create_dir_all(folder).map_err(HarnessError::io(folder, "create this folder"))?;
    let unwritable = || HarnessError::io(path, "write this file");
    let file = new_file(folder).map_err(unwritable())?;
    encode_gif(file.as_file(), frames).map_err(|error| unwritable()(std::io::Error::other(error)))?;
    guard::fresh::put(file, path).map_err(unwritable())?;
    Ok(())
}

fn encode_gif(file: &File, frames: &[(Image, u16)]) -> Result<(), gif::EncodingError> {
    let side = |length: u32| u16::try_from(length).expect("pictures have at most 4096 pixels a side");
    let Some((first, _)) = frames.first() else { return Ok(()) };
    let (width, height) = (side(first.width()), side(first.height()));
    let mut encoder = gif::Encoder::new(BufWriter::new(file), width, height, &[])?;
    encoder.set_repeat(gif::Repeat::Infinite)?;
    for (image, time) in frames {
        let mut frame = gif::Frame::from_rgb_speed(width, height, image.pixels(), GIF_SPEED);
        frame.delay = *time;
        encoder.write_frame(&frame)?;
    }
    Ok(())
}
