//! The fuzz targets on fixed seeds, so that they keep compiling and holding without a fuzzer.
#![allow(clippy::unwrap_used)]

mod stress;

use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::{Rng, SeedableRng};
use stress::{below, fuzzing};

#[test]
fn distances_of_arbitrary_bit_patterns() {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(3);
    for round in 0..300 {
        let mut data = vec![0; 1 + below(&mut rng, 160) as usize];
        rng.fill_bytes(&mut data);
        data[0] = round as u8;
        fuzzing::distance(&data);
    }
    fuzzing::distance(&[]);
}

#[test]
fn readers_of_damaged_files() {
    let seeds: [&[u8]; 6] = [
        b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1e0 1 -0.5\nf 1 2 3\nf -1 -2 -3\nl 1 2\np 3\n",
        b"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
        b"solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid s\n",
        &[0; 134],
        b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2 255 0 0\n",
        br#"{"asset":{"version":"2.0"},"nodes":[{"mesh":0,"scale":[1,2,3],"rotation":[0,1,0,1]}],"meshes":[{"primitives":[{"attributes":{"POSITION":0},"mode":5}]}],"accessors":[{"bufferView":0,"componentType":5120,"count":3,"type":"VEC3"}],"bufferViews":[{"buffer":0,"byteLength":12,"byteStride":4}],"buffers":[{"byteLength":12,"uri":"data:;base64,AAAAAQAAAAEAAAEA"}]}"#,
    ];
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(4);
    for seed in seeds {
        fuzzing::mesh(seed);
        for _ in 0..600 {
            let mut data = seed.to_vec();
            for _ in 0..=below(&mut rng, 4) {
                let at = below(&mut rng, data.len() as u64) as usize;
                match below(&mut rng, 5) {
                    0 => data[at] = rng.next_u64() as u8,
                    1 => data.truncate(at + 1),
                    2 => data.insert(at, b"0123456789-.e \n"[below(&mut rng, 15) as usize]),
                    3 => data[at] = data[at].wrapping_add(1),
                    _ => {
                        data.remove(at);
                        if data.is_empty() {
                            break;
                        }
                    }
                }
                if data.is_empty() {
                    break;
                }
            }
            fuzzing::mesh(&data);
        }
    }
}
