//! Is there a Vulkan device that can draw this? Asked before Bevy starts, which would panic.

use bevy::render::settings::{Backends, InstanceFlags, WgpuSettings};
use bevy::tasks::block_on;
use thiserror::Error;
use wgpu::{DeviceType, DownlevelFlags, Limits};

use crate::settings::quality::DeviceKind;

/// Why there is no device to draw with.
#[derive(Debug, Error)]
pub enum DeviceError {
    /// No Vulkan driver, or no device behind it.
    #[error(
        "no Vulkan device found: install the driver of your graphics card, or the software \
         driver (Debian and Ubuntu: `apt install mesa-vulkan-drivers`; the variable \
         VK_DRIVER_FILES, where it is set, must name a driver file)"
    )]
    NoVulkan,
    /// The chosen device is too small.
    #[error(
        "Vulkan device `{device}` is below the limits of Dolomite: {}; choose another device with \
         WGPU_ADAPTER_NAME (found: {}), or update its driver",
        .missing.join(", "), .found.join(", ")
    )]
    BelowLimits {
        /// Name of the device.
        device: String,
        /// Each limit that it misses, with what it has and what is needed.
        missing: Vec<String>,
        /// All devices.
        found: Vec<String>,
    },
    /// There is no display to open a window on.
    #[error(
        "no display to open a window on (neither WAYLAND_DISPLAY nor DISPLAY is set): start from \
         a desktop, under `xvfb-run`, or render without a window with `dolomite shot`"
    )]
    NoDisplay,
}

/// A device that can draw the game.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Device {
    /// Its name, as the driver gives it.
    pub name: String,
    /// What it is.
    pub kind: DeviceKind,
    /// Largest side of a texture, pixels.
    pub max_texture: u32,
}

/// What is asked of a device: name of the limit, its value, least value, and what needs it.
type Requirement = (&'static str, fn(&Limits) -> u64, u64);

/// The limits that the passes of the game need; all others are at least those of every Vulkan 1.1
/// device. The texture side is Bevy's shadow map and the 4K picture; storage buffers and their
/// size are the pools of the tessellation; the colour bytes are Bevy's G-buffer, 16 + 4 + 4 + 1,
/// aligned; the storage textures are Bevy's ambient light from the sky.
const REQUIRED: &[Requirement] = &[
    (
        "max_texture_dimension_2d",
        |l| l.max_texture_dimension_2d as u64,
        4096,
    ),
    (
        "max_texture_array_layers",
        |l| l.max_texture_array_layers as u64,
        256,
    ),
    ("max_bind_groups", |l| l.max_bind_groups as u64, 4),
    (
        "max_storage_buffers_per_shader_stage",
        |l| l.max_storage_buffers_per_shader_stage as u64,
        8,
    ),
    (
        "max_storage_textures_per_shader_stage",
        |l| l.max_storage_textures_per_shader_stage as u64,
        6,
    ),
    (
        "max_storage_buffer_binding_size",
        |l| l.max_storage_buffer_binding_size,
        128 << 20,
    ),
    (
        "max_compute_invocations_per_workgroup",
        |l| l.max_compute_invocations_per_workgroup as u64,
        256,
    ),
    (
        "max_compute_workgroup_storage_size",
        |l| l.max_compute_workgroup_storage_size as u64,
        16 << 10,
    ),
    (
        "max_color_attachments",
        |l| l.max_color_attachments as u64,
        4,
    ),
    (
        "max_color_attachment_bytes_per_sample",
        |l| l.max_color_attachment_bytes_per_sample as u64,
        32,
    ),
];

/// Downlevel capabilities without which nothing is drawn.
const REQUIRED_FLAGS: DownlevelFlags = DownlevelFlags::COMPUTE_SHADERS
    .union(DownlevelFlags::INDIRECT_EXECUTION)
    .union(DownlevelFlags::INDEPENDENT_BLEND);

/// The render settings of the game: Vulkan only, and indirect draws as they are.
///
/// `VALIDATION_INDIRECT_CALL` would put a validating dispatch before each indirect draw. Our
/// indirect arguments are written by our own passes within the capacity of their buffers.
pub fn wgpu_settings() -> WgpuSettings {
    let mut settings = WgpuSettings {
        backends: Some(Backends::VULKAN),
        ..WgpuSettings::default()
    };
    settings
        .instance_flags
        .remove(InstanceFlags::VALIDATION_INDIRECT_CALL);
    settings
}

/// Finds the device that Bevy will choose, and checks it.
///
/// Honours `WGPU_ADAPTER_NAME` and `WGPU_FORCE_FALLBACK_ADAPTER` as Bevy does.
///
/// # Errors
/// [`DeviceError::NoVulkan`] or [`DeviceError::BelowLimits`].
pub fn probe() -> Result<Device, DeviceError> {
    let settings = wgpu_settings();
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
    descriptor.backends = Backends::VULKAN;
    descriptor.flags = settings.instance_flags;
    let instance = wgpu::Instance::new(descriptor);
    let adapters = block_on(instance.enumerate_adapters(Backends::VULKAN));
    let found: Vec<String> = adapters
        .iter()
        .map(|adapter| adapter.get_info().name)
        .collect();

    let wanted = std::env::var("WGPU_ADAPTER_NAME").map(|name| name.to_lowercase());
    let named = wanted.ok().and_then(|name| {
        adapters
            .into_iter()
            .find(|adapter| adapter.get_info().name.to_lowercase().contains(&name))
    });
    let software_only = std::env::var("WGPU_FORCE_FALLBACK_ADAPTER")
        .is_ok_and(|value| !matches!(value.as_str(), "" | "0" | "false"));
    let adapter = match named {
        Some(adapter) => adapter,
        None => block_on(instance.request_adapter(&wgpu::RequestAdapterOptions {
            power_preference: settings.power_preference,
            force_fallback_adapter: software_only,
            compatible_surface: None,
        }))
        .map_err(|_| DeviceError::NoVulkan)?,
    };
    let info = adapter.get_info();
    let limits = adapter.limits();
    let missing = missing(&limits, adapter.get_downlevel_capabilities().flags);
    if !missing.is_empty() {
        return Err(DeviceError::BelowLimits {
            device: info.name,
            missing,
            found,
        });
    }
    Ok(Device {
        name: info.name,
        kind: match info.device_type {
            DeviceType::Cpu => DeviceKind::Software,
            DeviceType::DiscreteGpu => DeviceKind::Discrete,
            DeviceType::IntegratedGpu | DeviceType::VirtualGpu | DeviceType::Other => {
                DeviceKind::Integrated
            }
        },
        max_texture: limits.max_texture_dimension_2d,
    })
}

/// What a device lacks, in words.
fn missing(limits: &Limits, flags: DownlevelFlags) -> Vec<String> {
    let mut missing: Vec<String> = REQUIRED
        .iter()
        .filter(|(_, value, least)| value(limits) < *least)
        .map(|(name, value, least)| format!("{name} is {}, needed {least}", value(limits)))
        .collect();
    missing.extend(
        (REQUIRED_FLAGS - flags)
            .iter_names()
            .map(|(name, _)| format!("{name} is missing")),
    );
    missing
}

/// Whether a window can be opened: on Linux, whether a display server is named.
///
/// # Errors
/// [`DeviceError::NoDisplay`].
pub fn display() -> Result<(), DeviceError> {
    let named = |variable| std::env::var_os(variable).is_some_and(|value| !value.is_empty());
    if cfg!(target_os = "linux") && !named("WAYLAND_DISPLAY") && !named("DISPLAY") {
        return Err(DeviceError::NoDisplay);
    }
    Ok(())
}

#[cfg(test)]
#[expect(
    clippy::field_reassign_with_default,
    reason = "one limit at a time is changed, and each is looked at"
)]
mod tests {
    use super::*;

    #[test]
    fn the_limits_of_webgpu_are_enough_but_for_storage_textures() {
        let mut limits = Limits::default();
        limits.max_storage_textures_per_shader_stage = 6;
        assert_eq!(
            missing(&limits, DownlevelFlags::all()),
            Vec::<String>::new()
        );
    }

    #[test]
    fn each_missing_limit_is_named_with_both_numbers() {
        let mut limits = Limits::default();
        limits.max_storage_textures_per_shader_stage = 6;
        limits.max_storage_buffers_per_shader_stage = 4;
        limits.max_texture_dimension_2d = 2048;
        let flags = DownlevelFlags::all() - DownlevelFlags::INDIRECT_EXECUTION;
        let error = DeviceError::BelowLimits {
            device: "Toy".to_owned(),
            missing: missing(&limits, flags),
            found: vec!["Toy".to_owned(), "Other".to_owned()],
        }
        .to_string();
        for word in [
            "Toy",
            "max_storage_buffers_per_shader_stage is 4, needed 8",
            "max_texture_dimension_2d is 2048, needed 4096",
            "INDIRECT_EXECUTION is missing",
            "Other",
        ] {
            assert!(error.contains(word), "{error} does not say {word}");
        }
    }
}
