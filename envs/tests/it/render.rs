//! Pictures of environments.

use std::process::Command;

use envs::render::{Image, MAX_SIZE, RenderError, Renderer};
use envs::rng::{Purpose, stream};
use envs::{EnvError, EnvOptions, GoalEnv, GoalSource, Observation, Reward, Spec, make};

const SIZE: u32 = 260;

fn build(id: &str) -> Box<dyn GoalEnv> {
    let mut env = make(id, &EnvOptions::default()).unwrap();
    env.reset(&mut stream(7, Purpose::Environment)).unwrap();
    env
}

/// The colour of a maze's picture at `position`: the first coordinate runs downwards.
fn at(image: &Image, position: [f64; 2]) -> [u8; 3] {
    let [y, x] = position.map(|part| ((part + 1.0) / 2.0 * f64::from(SIZE)) as u32);
    image.pixel(x, y)
}

fn is_reddish([red, green, blue]: [u8; 3]) -> bool {
    red > green.saturating_add(30) && red > blue.saturating_add(30)
}

fn is_bluish([red, _, blue]: [u8; 3]) -> bool {
    blue > red.saturating_add(30)
}

#[test]
fn a_maze_shows_walls_goal_point_and_path() {
    let mut env = build("MazeA");
    env.set_goal(&[0.0, -0.5]).unwrap();
    let mut renderer = Renderer::new(env.as_ref(), SIZE, SIZE).unwrap();
    let first = renderer.frame(env.as_ref()).unwrap();
    assert_eq!((first.width(), first.height(), first.pixels().len()), (SIZE, SIZE, 3 * 260 * 260));
    let (wall, ground) = (at(&first, [-0.95, 0.3]), at(&first, [0.6, 0.3]));
    assert!(wall.iter().all(|channel| *channel < 100) && ground.iter().all(|channel| *channel > 200));
    assert_eq!(at(&first, [-10.0 / 13.0, -6.0 / 13.0]), wall, "row 1, column 3");
    assert_eq!(at(&first, [-6.0 / 13.0, -10.0 / 13.0]), ground, "row 3, column 1");
    assert!(is_reddish(at(&first, [0.06, -0.5])), "the goal is as wide as its threshold");
    assert!(!is_reddish(at(&first, [0.12, -0.5])));
    assert!(is_bluish(at(&first, [-10.0 / 13.0, -10.0 / 13.0])), "the point on its start");

    env.step(&[1.0, 0.0]).unwrap();
    env.step(&[1.0, 0.0]).unwrap();
    let halfway = [-10.0 / 13.0 + 0.1, -10.0 / 13.0];
    assert!(is_bluish(at(&renderer.frame(env.as_ref()).unwrap(), halfway)), "the path");
    renderer.begin_episode();
    assert!(!is_bluish(at(&renderer.frame(env.as_ref()).unwrap(), halfway)), "a new episode, a new path");
}

/// The renderer of a simulation, or none where this machine has no OpenGL.
fn simulation_renderer(env: &dyn GoalEnv) -> Option<Renderer> {
    match Renderer::new(env, SIZE, SIZE) {
        Ok(renderer) => Some(renderer),
        Err(RenderError::NoGraphics { .. }) => None,
        Err(other) => panic!("{other}"),
    }
}

fn reddish_pixels(image: &Image) -> usize {
    image.pixels().chunks_exact(3).filter(|rgb| is_reddish([rgb[0], rgb[1], rgb[2]])).count()
}

#[test]
fn a_simulation_is_drawn_upright_with_its_goal_and_without_being_touched() {
    let (mut env, mut twin) = (build("FetchReach"), build("FetchReach"));
    let Some(mut renderer) = simulation_renderer(env.as_ref()) else { return };
    env.set_goal(&[1.4, 1.0, 0.6]).unwrap();
    let with_goal = renderer.frame(env.as_ref()).unwrap();
    assert!(reddish_pixels(&with_goal) > 10, "{}", reddish_pixels(&with_goal));
    env.set_goal(&[1.3, 0.75, -50.0]).unwrap();
    let without = renderer.frame(env.as_ref()).unwrap();
    assert_eq!(reddish_pixels(&without), 0, "the model's own marker is hidden");
    let sky = without.pixel(SIZE / 2, 3);
    assert!(sky[1] > sky[0] && sky[1] > sky[2], "the reference's green sky is at the top: {sky:?}");

    for _ in 0..3 {
        env.step(&[0.5, -0.5, 0.2, 0.0]).unwrap();
        twin.step(&[0.5, -0.5, 0.2, 0.0]).unwrap();
        renderer.frame(env.as_ref()).unwrap();
    }
    assert_eq!(env.observation(), twin.observation());
    assert_ne!(renderer.frame(env.as_ref()).unwrap(), without, "the arm has moved");
}

#[test]
fn a_manipulation_goal_is_drawn_as_a_ghost() {
    let mut env = build("HandManipulateBlock");
    let Some(mut renderer) = simulation_renderer(env.as_ref()) else { return };
    let before = renderer.frame(env.as_ref()).unwrap();
    env.set_goal(&[1.05, 0.9, 0.25, 1.0, 0.0, 0.0, 0.0]).unwrap();
    assert_ne!(renderer.frame(env.as_ref()).unwrap(), before);
}

#[test]
fn a_renderer_serves_its_own_environment_only() {
    let (maze, reach) = (build("MazeA"), build("FetchReach"));
    let mut renderer = Renderer::new(maze.as_ref(), 10, 20).unwrap();
    let refused = renderer.frame(reach.as_ref()).unwrap_err();
    assert!(matches!(refused, RenderError::OtherEnvironment { env: "FetchReach" }), "{refused}");
    if let Some(mut renderer) = simulation_renderer(reach.as_ref()) {
        assert!(renderer.frame(build("FetchReach").as_ref()).is_ok(), "one built alike will do");
        let refused = renderer.frame(build("FetchPush").as_ref()).unwrap_err();
        assert!(matches!(refused, RenderError::OtherEnvironment { env: "FetchPush" }), "{refused}");
    }
}

#[test]
fn sizes_out_of_range_are_errors() {
    let maze = build("MazeB");
    for (width, height) in [(0, 10), (10, 0), (MAX_SIZE + 1, 10)] {
        let error = Renderer::new(maze.as_ref(), width, height).err().unwrap();
        assert!(matches!(error, RenderError::Size { .. }), "{error}");
    }
    let narrow = Renderer::new(maze.as_ref(), 1, MAX_SIZE).unwrap().frame(maze.as_ref()).unwrap();
    assert_eq!((narrow.width(), narrow.height()), (1, MAX_SIZE));
}

/// An environment from elsewhere that says nothing about its looks.
struct Faceless(Spec);

impl Reward for Faceless {
    fn reward(&self, _: &[f64], _: &[f64]) -> f64 {
        -1.0
    }
    fn success(&self, _: &[f64], _: &[f64]) -> bool {
        false
    }
}

impl GoalSource for Faceless {
    fn sample_goal(&mut self, _: &mut envs::rng::Rng, _: &mut [f64]) {}
}

impl GoalEnv for Faceless {
    fn step(&mut self, _: &[f64]) -> Result<(), EnvError> {
        Ok(())
    }
    fn spec(&self) -> &Spec {
        &self.0
    }
    fn reset(&mut self, _: &mut envs::rng::Rng) -> Result<(), EnvError> {
        Ok(())
    }
    fn set_goal(&mut self, _: &[f64]) -> Result<(), EnvError> {
        Ok(())
    }
    fn observation(&self) -> &Observation {
        const { &Observation { state: Vec::new(), achieved: Vec::new() } }
    }
    fn goal(&self) -> &[f64] {
        &[]
    }
}

#[test]
fn an_environment_without_looks_is_an_error() {
    let env = Faceless(build("Point").spec().clone());
    assert!(matches!(Renderer::new(&env, 10, 10), Err(RenderError::NotDrawable { env: "Point" })));
}

#[test]
#[ignore = "the process that the test below starts"]
fn draw_fetch_reach() {
    match Renderer::new(build("FetchReach").as_ref(), SIZE, SIZE) {
        Err(error @ RenderError::NoGraphics { .. }) => assert!(error.to_string().contains("libegl1")),
        Err(other) => panic!("{other}"),
        Ok(_) => panic!("drawn without OpenGL"),
    }
}

#[test]
fn a_machine_without_opengl_gets_an_error_that_says_what_to_install() {
    // EGL finds no vendor's library in an empty folder.
    let empty = tempfile::tempdir().unwrap();
    let child = Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "render::draw_fetch_reach", "--ignored"])
        .env("__EGL_VENDOR_LIBRARY_DIRS", empty.path())
        .output()
        .unwrap();
    assert!(child.status.success(), "{}", String::from_utf8_lossy(&child.stdout));
}
