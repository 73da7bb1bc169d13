//! Drawing simulations with MuJoCo's own renderer.

use std::sync::Arc;

use mujoco_rs::renderer::MjRenderer;
use mujoco_rs::wrappers::mj_data::MjData;
use mujoco_rs::wrappers::mj_model::{MjModel, MjtGeom, MjtObj};
use mujoco_rs::wrappers::mj_visualization::MjvCamera;

use super::{GoalShape, Image, RenderError, SimulationScene, Viewpoint};

/// Spheres that a goal may consist of.
const MAX_SPHERES: usize = 16;

/// Draws simulations of one model.
///
/// It has a copy of the model and a state of its own, so that neither markers nor `mj_forward` touch the
/// environment.
pub(super) struct SimulationRenderer {
    /// The environment's model, to recognise it by.
    source: Arc<MjModel>,
    data: MjData<Arc<MjModel>>,
    renderer: MjRenderer<Arc<MjModel>>,
    width: u32,
    height: u32,
}

impl SimulationRenderer {
    pub(super) fn new(scene: &SimulationScene<'_>, width: u32, height: u32) -> Result<Self, RenderError> {
        let source = scene.sim.shared_model();
        let mut model = MjModel::clone(&source).ok_or(RenderError::Memory)?;
        let (columns, rows) = (width.cast_signed(), height.cast_signed());
        let buffer = &mut model.vis_mut().global;
        (buffer.offwidth, buffer.offheight) = (columns.max(buffer.offwidth), rows.max(buffer.offheight));
        for name in scene.hidden_sites {
            if let Ok(site) = usize::try_from(model.name_to_id(MjtObj::mjOBJ_SITE, name)) {
                model.site_rgba_mut()[site][3] = 0.0;
            }
        }
        let model = Arc::new(model);
        let renderer = MjRenderer::builder()
            .width(width)
            .height(height)
            .num_visual_user_geom(MAX_SPHERES as u32)
            .camera(camera(scene.viewpoint))
            .build(Arc::clone(&model))
            .map_err(|error| RenderError::NoGraphics { source: error.into() })?;
        Ok(Self { source, data: MjData::new(model), renderer, width, height })
    }

    /// Whether `scene` shows the model that this renderer was made for.
    pub(super) fn fits(&self, scene: &SimulationScene<'_>) -> bool {
        Arc::ptr_eq(&self.source, &scene.sim.shared_model())
    }

    pub(super) fn draw(&mut self, scene: &SimulationScene<'_>) -> Result<Image, RenderError> {
        self.take_state(scene);
        self.mark(&scene.goal);
        self.data.forward();
        self.renderer.sync(&mut self.data);
        let pixels = self.renderer.rgb_flat().unwrap_or_default();
        // OpenGL's first row is the lowest.
        let rows = pixels.chunks_exact(3 * self.width as usize).rev();
        Ok(Image::new(self.width, self.height, rows.flatten().copied().collect()))
    }

    fn take_state(&mut self, scene: &SimulationScene<'_>) {
        let from = scene.sim.data();
        self.data.qpos_mut().copy_from_slice(from.qpos());
        self.data.qvel_mut().copy_from_slice(from.qvel());
        self.data.mocap_pos_mut().copy_from_slice(from.mocap_pos());
        self.data.mocap_quat_mut().copy_from_slice(from.mocap_quat());
    }

    fn mark(&mut self, goal: &GoalShape) {
        match goal {
            GoalShape::Ghost { qpos, pose } => {
                self.data.qpos_mut()[*qpos..*qpos + 7].copy_from_slice(pose);
            }
            GoalShape::Spheres(spheres) => {
                let scene = self.renderer.user_scene_mut();
                scene.clear_geom();
                for sphere in spheres.iter().take(MAX_SPHERES) {
                    let size = Some([sphere.radius; 3]);
                    scene.create_geom(
                        MjtGeom::mjGEOM_SPHERE,
                        size,
                        Some(sphere.centre),
                        None,
                        Some(sphere.rgba),
                    );
                }
            }
        }
    }
}

fn camera(viewpoint: &Viewpoint) -> MjvCamera {
    let Viewpoint { lookat, distance, azimuth, elevation } = *viewpoint;
    MjvCamera { lookat, distance, azimuth, elevation, ..MjvCamera::default() }
}
