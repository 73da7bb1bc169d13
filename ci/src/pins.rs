//! The native parts of the project: which wheels they come from, pinned by hash, and what of them is kept.
//!
//! The versions belong together: tch 0.24 is written for torch 2.11.0, whose libtorch_cpu.so loads the CUDA
//! 13.0 runtime and CUPTI even where there is no GPU; mujoco-rs 2.3.5 is written for MuJoCo 3.3.7. Sizes are
//! in bytes.

/// A file or folder of a wheel, and where it goes in the part's folder. Folders end in `/` on both sides.
#[derive(Debug)]
pub(crate) struct Take {
    pub(crate) from: &'static str,
    pub(crate) to: &'static str,
}

const fn take(from: &'static str, to: &'static str) -> Take {
    Take { from, to }
}

/// One wheel, as pip knows it, and what is kept of it.
#[derive(Debug)]
pub(crate) struct Wheel {
    pub(crate) project: &'static str,
    pub(crate) version: &'static str,
    /// Hash of the wheel file, in lower-case hexadecimal. One version has many wheels with different
    /// libraries.
    pub(crate) sha256: &'static str,
    pub(crate) bytes: u64,
    pub(crate) takes: &'static [Take],
}

/// What set-up adds to the files of the wheels.
#[derive(Debug)]
pub(crate) enum Addition {
    Text { path: &'static str, text: &'static str },
    Link { path: &'static str, target: &'static str },
}

/// A folder below `.native`, fetched and replaced as a whole.
#[derive(Debug)]
pub(crate) struct Part {
    /// Name of the folder.
    pub(crate) name: &'static str,
    pub(crate) title: &'static str,
    pub(crate) wheels: &'static [Wheel],
    pub(crate) additions: &'static [Addition],
    /// What the unpacked files take on disk.
    pub(crate) unpacked_bytes: u64,
    /// If this environment variable names a folder of the user's own, that is used and nothing is fetched.
    pub(crate) variable: &'static str,
    /// A file that any such folder holds.
    pub(crate) proof: &'static str,
}

impl Part {
    /// What pip fetches for this part, in bytes.
    pub(crate) fn download_bytes(&self) -> u64 {
        self.wheels.iter().map(|wheel| wheel.bytes).sum()
    }

    /// Everything that decides what the folder holds, one item per line. A folder made from other lines is
    /// out of date.
    pub(crate) fn recipe(&self) -> Vec<String> {
        let mut lines = Vec::new();
        for wheel in self.wheels {
            lines.push(format!("{}=={} sha256:{}", wheel.project, wheel.version, wheel.sha256));
            lines.extend(wheel.takes.iter().map(|take| format!("{} -> {}", take.from, take.to)));
        }
        lines.extend(self.additions.iter().map(|addition| match addition {
            Addition::Text { path, text } => format!("{path} = {text:?}"),
            Addition::Link { path, target } => format!("{path} -> {target}"),
        }));
        lines
    }
}

/// The Python whose wheels are pinned. The Python that runs pip may be another one.
pub(crate) const PYTHON_VERSION: &str = "3.11";

/// The platform tags of the wheels, newest first.
pub(crate) const PLATFORMS: [&str; 7] = [
    "manylinux_2_28_x86_64",
    "manylinux_2_27_x86_64",
    "manylinux_2_26_x86_64",
    "manylinux_2_25_x86_64",
    "manylinux_2_24_x86_64",
    "manylinux_2_17_x86_64",
    "manylinux2014_x86_64",
];

/// Every part, in the order in which they are fetched.
pub(crate) const PARTS: [Part; 3] = [
    Part {
        name: "libtorch",
        title: "libtorch 2.11.0 for the CPU",
        wheels: &[TORCH, CUDA_RUNTIME, CUPTI],
        additions: &[
            // The wheel's own libtorch.so, which the linker is asked for, pulls in the CUDA half.
            Addition::Text { path: "lib/libtorch.so", text: "INPUT(libtorch_cpu.so)\n" },
            // torch-sys reads it to refuse other versions.
            Addition::Text { path: "build-version", text: "2.11.0\n" },
        ],
        unpacked_bytes: 524_000_000,
        variable: "LIBTORCH",
        proof: "lib/libtorch_cpu.so",
    },
    Part {
        name: "mujoco",
        title: "MuJoCo 3.3.7",
        wheels: &[MUJOCO],
        additions: &[Addition::Link { path: "libmujoco.so", target: "libmujoco.so.3.3.7" }],
        unpacked_bytes: 5_200_000,
        variable: "MUJOCO_DYNAMIC_LINK_DIR",
        proof: "libmujoco.so",
    },
    Part {
        name: "assets",
        title: "robot models of gymnasium-robotics 1.4.2",
        wheels: &[GYMNASIUM_ROBOTICS],
        additions: &[],
        unpacked_bytes: 3_900_000,
        variable: "GOALBENCH_ASSETS",
        proof: "fetch/reach.xml",
    },
];

const TORCH: Wheel = Wheel {
    project: "torch",
    version: "2.11.0",
    sha256: "7aa2f9bbc6d4595ba72138026b2074be1233186150e9292865e04b7a63b8c67a",
    bytes: 530_604_548,
    takes: &[
        take("torch/include/", "include/"),
        take("torch/lib/libc10.so", "lib/libc10.so"),
        take("torch/lib/libgomp.so.1", "lib/libgomp.so.1"),
        take("torch/lib/libtorch_cpu.so", "lib/libtorch_cpu.so"),
        take("torch-2.11.0.dist-info/licenses/", "licenses/torch/"),
    ],
};

const CUDA_RUNTIME: Wheel = Wheel {
    project: "nvidia-cuda-runtime",
    version: "13.0.96",
    sha256: "7f82250d7782aa23b6cfe765ecc7db554bd3c2870c43f3d1821f1d18aebf0548",
    bytes: 2_243_632,
    takes: &[
        take("nvidia/cu13/lib/libcudart.so.13", "lib/libcudart.so.13"),
        take("nvidia_cuda_runtime-13.0.96.dist-info/licenses/", "licenses/nvidia-cuda-runtime/"),
    ],
};

const CUPTI: Wheel = Wheel {
    project: "nvidia-cuda-cupti",
    version: "13.0.85",
    sha256: "4eb01c08e859bf924d222250d2e8f8b8ff6d3db4721288cf35d14252a4d933c8",
    bytes: 10_715_597,
    takes: &[
        take("nvidia/cu13/lib/libcupti.so.13", "lib/libcupti.so.13"),
        take("nvidia_cuda_cupti-13.0.85.dist-info/licenses/", "licenses/nvidia-cuda-cupti/"),
    ],
};

const MUJOCO: Wheel = Wheel {
    project: "mujoco",
    version: "3.3.7",
    sha256: "9371506f0df2d82152685fc8d38465843abcea8d371745ea7c125001e8f3f2d8",
    bytes: 6_783_128,
    takes: &[
        take("mujoco/libmujoco.so.3.3.7", "libmujoco.so.3.3.7"),
        take("mujoco-3.3.7.dist-info/licenses/", "licenses/"),
    ],
};

const GYMNASIUM_ROBOTICS: Wheel = Wheel {
    project: "gymnasium-robotics",
    version: "1.4.2",
    sha256: "a1743530431cb377e6b3b956d284bc96436fc68bac1648ef205054c178e7dc4b",
    bytes: 26_174_405,
    takes: &[
        take("gymnasium_robotics/envs/assets/LICENSE.md", "LICENSE.md"),
        take("gymnasium_robotics/envs/assets/fetch/", "fetch/"),
        take("gymnasium_robotics/envs/assets/hand/", "hand/"),
        take("gymnasium_robotics/envs/assets/stls/", "stls/"),
        take("gymnasium_robotics/envs/assets/textures/", "textures/"),
        take("gymnasium_robotics-1.4.2.dist-info/licenses/LICENSE", "LICENSE-gymnasium-robotics"),
    ],
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pins_are_well_formed_and_their_places_stay_inside_the_part() {
        for part in &PARTS {
            for wheel in part.wheels {
                assert_eq!(wheel.sha256.len(), 64, "{}", wheel.project);
                assert!(wheel.sha256.bytes().all(|byte| matches!(byte, b'0'..=b'9' | b'a'..=b'f')));
                for take in wheel.takes {
                    assert_eq!(take.from.ends_with('/'), take.to.ends_with('/'), "{take:?}");
                    assert!(!take.to.starts_with('/') && !take.to.contains(".."), "{take:?}");
                }
            }
        }
    }

    #[test]
    fn recipe_changes_with_anything_that_decides_the_content() {
        let [libtorch, mujoco, _] = &PARTS;
        let recipe = mujoco.recipe();
        assert_eq!(recipe[0], format!("mujoco==3.3.7 sha256:{}", MUJOCO.sha256));
        assert_eq!(recipe.last().map(String::as_str), Some("libmujoco.so -> libmujoco.so.3.3.7"));
        assert!(libtorch.recipe().contains(&r#"build-version = "2.11.0\n""#.to_owned()));
    }

    #[test]
    fn libtorch_downloads_its_three_wheels() {
        assert_eq!(PARTS[0].download_bytes(), 543_563_777);
    }
}
