#define_import_path dolomite::deferred::standard

#import dolomite::deferred::types::{Incident, Surface}

// Bevy's standard material: diffuse light by Burley (2012), specular by GGX with height-correlated Smith
// visibility (Heitz 2014), Schlick's Fresnel term, light scattered more than once (Kulla and Conty 2017, as
// Filament has it), a clearcoat with Kelemen's visibility, and lights that are spheres (Karis 2013).
// `l`, `v`, `h`, `n` are the directions to the light, the camera, halfway between them, and the normal.

const INVERSE_PI: f32 = 0.318309886;

fn fifth_power(x: f32) -> f32 {
    let square = x * x;
    return square * square * x;
}

fn schlick(least: f32, f90: f32, cosine: f32) -> f32 {
    return least + (f90 - least) * fifth_power(1.0 - cosine);
}

// α of GGX; clamped, so that the smallest highlight can still be computed.
fn roughness_of(perceptual: f32) -> f32 {
    let clamped = clamp(perceptual, 0.089, 1.0);
    return clamped * clamped;
}

// Halfway between two directions; of opposite ones, which have no middle, it is 0 and so are its cosines.
fn halfway(l: vec3<f32>, v: vec3<f32>) -> vec3<f32> {
    let sum = l + v;
    return sum * inverseSqrt(max(dot(sum, sum), 1e-20));
}

// 1/sr.
fn burley(roughness: f32, n_dot_v: f32, n_dot_l: f32, l_dot_h: f32) -> f32 {
    let f90 = 0.5 + 2.0 * roughness * l_dot_h * l_dot_h;
    return schlick(1.0, f90, n_dot_l) * schlick(1.0, f90, n_dot_v) * INVERSE_PI;
}

// Distribution of microfacet normals, 1/sr. The sine is that of a cross product: from the cosine it would be
// lost where it counts, in the middle of a highlight.
fn ggx(roughness: f32, n: vec3<f32>, h: vec3<f32>) -> f32 {
    let across = cross(n, h);
    let along = saturate(dot(n, h)) * roughness;
    // At least α² = 6e-5 where light arrives; 0 between opposite directions, where what comes of it is multiplied by 0.
    let k = roughness / max(dot(across, across) + along * along, 1e-9);
    return k * k * INVERSE_PI;
}

// Visibility over 4 (n·v)(n·l), height-correlated.
fn smith(roughness: f32, n_dot_v: f32, n_dot_l: f32) -> f32 {
    let a2 = roughness * roughness;
    let from_view = n_dot_l * sqrt((n_dot_v - a2 * n_dot_v) * n_dot_v + a2);
    let from_light = n_dot_v * sqrt((n_dot_l - a2 * n_dot_l) * n_dot_l + a2);
    return 0.5 / (from_view + from_light);
}

// Where a sphere of light is reflected from, and how rough the surface then seems.
struct Highlight {
    to_light: vec3<f32>,
    roughness: f32,
    // What the sphere's size leaves of the peak.
    intensity: f32,
}

fn highlight(surface: Surface, light: Incident, roughness: f32) -> Highlight {
    if light.radius <= 0.0 {
        return Highlight(light.to_light, roughness, 1.0);
    }
    let reflected = reflect(-surface.view, surface.normal);
    let offset = light.to_light * light.distance;
    // Positive, so that the nearest point of the ray lies before the surface.
    let along = max(1e-4, dot(offset, reflected));
    let to_ray = along * reflected - offset;
    let nearest = offset + to_ray * saturate(light.radius * inverseSqrt(max(dot(to_ray, to_ray), 1e-20)));
    let seeming = saturate(roughness + light.radius / (2.0 * max(light.distance, 1e-20)));
    let peak = roughness / seeming;
    let smooth_part = (1.0 - roughness) * (1.0 - roughness);
    let to_light = nearest * inverseSqrt(max(dot(nearest, nearest), 1e-20));
    return Highlight(to_light, mix(roughness, seeming, 1.0 - smooth_part * smooth_part), peak * peak);
}

// What the solid angle of a sphere takes from light at a grazing angle.
fn grazing(light: Incident, n_dot_l: f32) -> f32 {
    if light.radius <= 0.0 {
        return 1.0;
    }
    let ratio = light.radius / max(light.distance, 1e-20);
    return saturate(n_dot_l / max(n_dot_l + ratio * ratio, 1e-4));
}

// Reflected radiance, cd/m².
fn standard(surface: Surface, light: Incident) -> vec3<f32> {
    let n = surface.normal;
    let v = surface.view;
    let n_dot_l = saturate(dot(n, light.to_light));
    let l_dot_h = saturate(dot(light.to_light, halfway(light.to_light, v)));
    let diffuse = surface.diffuse * (burley(surface.roughness, surface.n_dot_v, n_dot_l, l_dot_h) * n_dot_l);

    let shine = highlight(surface, light, surface.roughness);
    let h = halfway(shine.to_light, v);
    let shine_n_dot_l = saturate(dot(n, shine.to_light));
    let f90 = saturate(dot(surface.at_normal, vec3(50.0 * 0.33)));
    let fresnel = surface.at_normal + (f90 - surface.at_normal) * fifth_power(1.0 - saturate(dot(shine.to_light, h)));
    let lobe = shine.intensity * ggx(shine.roughness, n, h) * smith(shine.roughness, surface.n_dot_v, shine_n_dot_l);
    let scattered = 1.0 + surface.at_normal * surface.energy;
    let specular = fresnel * scattered * (lobe * shine_n_dot_l * grazing(light, shine_n_dot_l));

    if surface.clearcoat <= 0.0 {
        return (diffuse + specular) * light.color;
    }
    let coat = highlight(surface, light, surface.clearcoat_roughness);
    let coat_h = halfway(coat.to_light, v);
    let coat_n_dot_l = saturate(dot(n, coat.to_light));
    let coat_l_dot_h = saturate(dot(coat.to_light, coat_h));
    let coat_fresnel = schlick(0.04, 1.0, coat_l_dot_h) * surface.clearcoat;
    // Kelemen's visibility.
    let kelemen = 0.25 / max(coat_l_dot_h * coat_l_dot_h, 1e-20);
    let coat_lobe = coat.intensity * ggx(coat.roughness, n, coat_h) * kelemen * coat_fresnel;
    let through = 1.0 - coat_fresnel;
    let coat_light = coat_lobe * grazing(light, coat_n_dot_l) * coat_n_dot_l;
    return ((diffuse + specular * through) * through + coat_light) * light.color;
}
