// Loads an export of Parallax Probes for three.js and shows its probes in materials.
//
//   const probes = await loadParallaxProbes('probes/');
//   showProbe(floor.material, probes.get('Hall'));           // MeshStandardMaterial or MeshPhysicalMaterial
//   wall.material = mirrorMaterial(probes.get('Hall'), 0.1); // a plain mirror of that roughness

import {
    CubeTexture, DataTexture, GLSL3, HalfFloatType, LinearFilter, LinearMipmapLinearFilter, NoColorSpace, RGBAFormat,
    ShaderMaterial, Vector3,
} from 'three';
import { read } from 'three/addons/libs/ktx-parse.module.js';

/** The probes of an export by name: {record, levels, shader, uniforms}. `folder` ends with a slash. */
export async function loadParallaxProbes(folder) {
    const { probes } = await (await fetched(`${folder}parallax_probes.json`)).json();
    const loaded = await Promise.all(probes.map(async (record) => {
        const [levels, shader] = await Promise.all([
            fetched(folder + record.pictures.ktx2).then((answer) => answer.arrayBuffer()).then(cubemap),
            fetched(folder + record.shader).then((answer) => answer.text()),
        ]);
        return [record.name, { record, levels, shader, uniforms: uniforms(record, levels) }];
    }));
    return new Map(loaded);
}

/** Lets a standard or physical material reflect a probe where it has the surface, and what it reflected elsewhere. */
export function showProbe(material, probe) {
    material.onBeforeCompile = (program) => {
        Object.assign(program.uniforms, probe.uniforms);
        program.vertexShader = program.vertexShader
            .replace('void main() {', 'varying vec3 pp_Position;\nvoid main() {')
            .replace('#include <project_vertex>', `#include <project_vertex>
                vec4 pp_place = vec4(transformed, 1.0);
                #ifdef USE_INSTANCING
                    pp_place = instanceMatrix * pp_place;
                #endif
                pp_Position = (modelMatrix * pp_place).xyz;`);
        program.fragmentShader = program.fragmentShader
            .replace('void main() {', `uniform samplerCube pp_levels;\nvarying vec3 pp_Position;\n${probe.shader}\nvoid main() {`)
            .replace('#include <lights_fragment_maps>', `#include <lights_fragment_maps>
                vec3 pp_normal = inverseTransformDirection(geometryNormal, viewMatrix);
                vec3 pp_incoming = normalize(cameraPosition - pp_Position);
                vec4 pp_seen = parallax_probe(pp_levels, pp_Position, pp_incoming, pp_normal, roughnessFactor);
                radiance = mix(radiance, pp_seen.rgb, pp_seen.a);`);
    };
    material.customProgramCacheKey = () => probe.record.shader;
    material.needsUpdate = true;
}

/** A material that is nothing but a mirror of a roughness. */
export function mirrorMaterial(probe, roughness = 0) {
    return new ShaderMaterial({
        glslVersion: GLSL3,
        uniforms: { ...probe.uniforms, pp_rough: { value: roughness } },
        vertexShader: `
            out vec3 place;
            out vec3 facing;
            void main() {
                vec4 world = modelMatrix * vec4(position, 1.0);
                place = world.xyz;
                facing = transpose(inverse(mat3(modelMatrix))) * normal;
                gl_Position = projectionMatrix * viewMatrix * world;
            }`,
        fragmentShader: `
            uniform samplerCube pp_levels;
            uniform float pp_rough;
            in vec3 place;
            in vec3 facing;
            out vec4 color;
            ${probe.shader}
            void main() {
                vec3 incoming = normalize(cameraPosition - place);
                vec4 seen = parallax_probe(pp_levels, place, incoming, normalize(facing), pp_rough);
                color = vec4(seen.rgb * seen.a, 1.0);
            }`,
    });
}

async function fetched(url) {
    const answer = await fetch(url);
    if (!answer.ok) throw new Error(`${url}: ${answer.status} ${answer.statusText}`);
    return answer;
}

function cubemap(buffer) {
    const { pixelWidth, levels } = read(new Uint8Array(buffer));
    const cubes = levels.map(({ levelData }, level) => {
        const width = Math.max(pixelWidth >> level, 1);
        const texels = new Uint16Array(levelData.slice().buffer);
        const faces = [0, 1, 2, 3, 4, 5].map((face) => {
            const count = 4 * width * width;
            return new DataTexture(texels.subarray(face * count, (face + 1) * count), width, width, RGBAFormat, HalfFloatType);
        });
        return new CubeTexture(faces);
    });
    const [sharpest, ...others] = cubes;
    sharpest.mipmaps = others;
    sharpest.format = RGBAFormat;
    sharpest.type = HalfFloatType;
    sharpest.colorSpace = NoColorSpace;
    sharpest.generateMipmaps = false;
    sharpest.magFilter = LinearFilter;
    sharpest.minFilter = LinearMipmapLinearFilter;
    sharpest.needsUpdate = true;
    return sharpest;
}

function uniforms(record, levels) {
    const numbers = Object.entries(record.numbers).map(([name, value]) => [
        name, { value: Array.isArray(value) ? new Vector3(...value) : value },
    ]);
    return { ...Object.fromEntries(numbers), pp_levels: { value: levels } };
}
