//! What bindgen makes of <kerf/kerf.h>: structs of the size that the header's initialisers say, functions,
//! callbacks, and the sentence of an error.

#[allow(non_camel_case_types, non_snake_case, non_upper_case_globals, dead_code)]
#[rustfmt::skip]
mod kerf {
    include!(env!("KERF_BINDINGS"));
}

use kerf::*;
use std::ffi::{c_void, CStr};
use std::ptr::{null, null_mut};

const VERTICES: [f32; 12] = [0., 0., 0., 1., 0., 0., 1., 1., 0., 0., 1., 0.];

fn square(triangles: &[u32]) -> kerf_mesh {
    kerf_mesh {
        struct_size: std::mem::size_of::<kerf_mesh>() as _,
        vertices: VERTICES.as_ptr(),
        vertex_count: (VERTICES.len() / 3) as _,
        vertex_stride: 0,
        triangles: triangles.as_ptr(),
        triangle_count: (triangles.len() / 3) as _,
        triangle_stride: 0,
        mask: !0,
    }
}

fn last_error() -> String {
    unsafe { CStr::from_ptr(kerf_last_error()) }.to_string_lossy().into_owned()
}

unsafe extern "C" fn is_not_first(asked: *mut c_void, hit: *const kerf_hit) -> i32 {
    *(asked as *mut u32) += 1;
    ((*hit).primitive != 0) as i32
}

fn main() {
    unsafe {
        assert_eq!(kerf_version(), KERF_VERSION_NUMBER);

        let mut bvh: *mut kerf_bvh = null_mut();
        let status = kerf_build(&square(&[0, 1, 2, 0, 2, 3, 1, 2, 9]), 1, null(), &mut bvh);
        assert_eq!(status, kerf_status_KERF_INDEX_OUT_OF_RANGE);
        assert!(bvh.is_null() && last_error().contains('9'), "{}", last_error());

        let status = kerf_build(&square(&[0, 1, 2, 0, 2, 3]), 1, null(), &mut bvh);
        assert_eq!(status, kerf_status_KERF_OK, "{}", last_error());
        let ray = kerf_ray { origin: [0.75, 0.25, 2.], direction: [0., 0., -1.], t_min: 0., t_max: 10. };
        let mut hit: kerf_hit = std::mem::zeroed();
        assert_ne!(kerf_intersect(bvh, &ray, &mut hit), 0);
        assert_eq!((hit.primitive, hit.mesh, hit.t), (0, 0, 2.));

        let mut asked = 0u32;
        let context = &mut asked as *mut u32 as *mut c_void;
        let found = kerf_intersect_filtered(bvh, &ray, !0, Some(is_not_first), context, &mut hit);
        assert_eq!((found, asked, hit.primitive), (0, 1, KERF_INVALID_ID));
        kerf_bvh_release(bvh);
    }
    println!("Rust: as in C");
}
