//! Pictures of environments, without a screen.
//!
//! What lies in the plane is drawn from above. Simulations are drawn by MuJoCo through EGL; on a machine
//! without a graphics card Mesa's software renderer does (Debian's `libegl1` and `libgl1-mesa-dri`).

mod image;
mod plane;
mod simulation;

use crate::env::GoalEnv;
use crate::scene::{GoalShape, Viewpoint};

pub use crate::scene::{PlaneScene, Rectangle, Scene, SimulationScene};
pub use image::Image;

use plane::PlaneRenderer;
use simulation::SimulationRenderer;

/// Largest width and height of a picture, pixels.
pub const MAX_SIZE: u32 = 4096;

/// Why there is no picture.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RenderError {
    /// Width or height is out of range.
    #[error("a picture of {width} × {height} pixels: both must be 1 to {MAX_SIZE}")]
    Size {
        /// Width asked for.
        width: u32,
        /// Height asked for.
        height: u32,
    },
    /// The environment has no picture.
    #[error("{env} cannot be drawn")]
    NotDrawable {
        /// Environment id.
        env: &'static str,
    },
    /// The renderer was made for another environment.
    #[error("the renderer was made for another environment than {env}")]
    OtherEnvironment {
        /// Environment id.
        env: &'static str,
    },
    /// There is no OpenGL on this machine, or it does not work.
    #[error("OpenGL cannot be used without a screen (on Debian install libegl1 and libgl1-mesa-dri)")]
    NoGraphics {
        /// What EGL says.
        source: Box<dyn std::error::Error + Send + Sync>,
    },
    /// There is too little memory.
    #[error("there is too little memory for the picture")]
    Memory,
    /// The picture cannot be packed.
    #[error("the picture cannot be packed as PNG")]
    Png {
        /// Why.
        source: Box<dyn std::error::Error + Send + Sync>,
    },
}

/// Draws one environment, again and again. It stays on the thread that made it.
///
/// ```
/// use envs::render::Renderer;
///
/// let env = envs::make("MazeA", &envs::EnvOptions::default())?;
/// let mut renderer = Renderer::new(env.as_ref(), 64, 64)?;
/// let png = renderer.frame(env.as_ref())?.to_png()?;
/// assert!(png.starts_with(b"\x89PNG"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Renderer {
    kind: Kind,
}

enum Kind {
    Plane(PlaneRenderer),
    Simulation(Box<SimulationRenderer>),
}

impl Renderer {
    /// A renderer of `width` × `height` pixels for `env` and others built alike.
    ///
    /// # Errors
    /// [`RenderError`]; [`RenderError::NoGraphics`] only for simulations.
    pub fn new(env: &dyn GoalEnv, width: u32, height: u32) -> Result<Self, RenderError> {
        if ![width, height].iter().all(|side| (1..=MAX_SIZE).contains(side)) {
            return Err(RenderError::Size { width, height });
        }
        let kind = match scene_of(env)? {
            Scene::Plane(_) => Kind::Plane(PlaneRenderer::new(width, height)),
            Scene::Simulation(scene) => {
                Kind::Simulation(Box::new(SimulationRenderer::new(&scene, width, height)?))
            }
        };
        Ok(Self { kind })
    }

    /// Forgets the path drawn so far; call it after a reset. Only pictures of the plane show a path.
    pub fn begin_episode(&mut self) {
        if let Kind::Plane(renderer) = &mut self.kind {
            renderer.forget_path();
        }
    }

    /// A picture of `env` as it is now, its goal included. The environment does not notice.
    ///
    /// # Errors
    /// [`RenderError::OtherEnvironment`], [`RenderError::NotDrawable`], [`RenderError::Memory`].
    pub fn frame(&mut self, env: &dyn GoalEnv) -> Result<Image, RenderError> {
        match (&mut self.kind, scene_of(env)?) {
            (Kind::Plane(renderer), Scene::Plane(scene)) => renderer.draw(&scene),
            (Kind::Simulation(renderer), Scene::Simulation(scene)) if renderer.fits(&scene) => {
                renderer.draw(&scene)
            }
            _ => Err(RenderError::OtherEnvironment { env: env.spec().id }),
        }
    }
}

fn scene_of(env: &dyn GoalEnv) -> Result<Scene<'_>, RenderError> {
    env.scene().ok_or(RenderError::NotDrawable { env: env.spec().id })
}
