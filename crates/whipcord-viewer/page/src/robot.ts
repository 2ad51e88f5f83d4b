// One robot in space: backbone, disks and cables in the shape that a model found.

import {
  ExtrudeGeometry,
  Group,
  Mesh,
  Path,
  Quaternion as Turn,
  Shape,
  Vector2,
  type BufferGeometry,
  type Material,
  type MeshStandardMaterialParameters,
} from "three";

import { linear, parse, type Rgb } from "./colours";
import { course, rotate } from "./geometry";
import { NEUTRAL } from "./legend";
import type { Disk, Scene, Solved } from "./protocol";
import { surface, type Surface } from "./surface";
import { circle, ringsAlong, square, Tube, type Outline, type Ring } from "./tube";

/** Colours of a robot: of the backbone at each station, of each cable at each of its points, of each disk. */
export interface Paint {
  backbone: (station: number) => Rgb;
  cable: (cable: number, station: number) => Rgb;
  disk: (disk: number) => Rgb;
}

/** Width of a backbone that is not known, relative to its length. */
const THIN = 0.006;
/** Width of cables, relative to the length of the robot. */
const CABLE = 0.0022;
const SIDES = 20;
const CABLE_SIDES = 8;
const RIM_SIDES = 48;
const HOLE_SIDES = 12;

export class RobotMesh {
  readonly group = new Group();
  readonly #scene: Scene;
  readonly #backbone: Tube;
  readonly #cables: Tube[];
  readonly #disks: Mesh<BufferGeometry, Surface>[];
  readonly #materials: Surface[] = [];
  readonly #holeToHole: boolean;
  #stale = false;

  constructor(scene: Scene, model: string) {
    this.#scene = scene;
    this.#holeToHole = scene.models.find((choice) => choice.name === model)?.hole_to_hole ?? false;
    const { outline, inner } = profile(scene);
    this.#backbone = new Tube(outline, inner);
    this.#cables = scene.cables.map(() => new Tube(circle(CABLE_SIDES)));
    this.group.name = model;
    [this.#backbone, ...this.#cables].forEach((tube, i) => {
      const mesh = new Mesh(tube.geometry, this.#material({ vertexColors: true, roughness: 0.55 }));
      mesh.name = i === 0 ? "backbone" : `cable ${scene.cables[i - 1]!.name}`;
      mesh.frustumCulled = false;
      this.group.add(mesh);
    });
    const shapes = new Map<string, BufferGeometry>();
    this.#disks = scene.disks.map((disk, i) => {
      const key = JSON.stringify([disk.radius, disk.thickness, disk.hole_radius, disk.holes]);
      const geometry = shapes.get(key) ?? plate(disk);
      shapes.set(key, geometry);
      const mesh = new Mesh(geometry, this.#material({ roughness: 0.8, transparent: true, opacity: 0.82 }));
      mesh.name = `disk ${i + 1}`;
      this.group.add(mesh);
      return mesh;
    });
  }

  update(solved: Solved, paint: Paint): void {
    const scene = this.#scene;
    this.#backbone.update(
      scene.stations.map((_, i) => this.#ring(solved, i)),
      scene.stations.map((_, i) => paint.backbone(i)),
    );
    scene.cables.forEach((cable, k) => {
      const slack = solved.cables[k]?.slack ?? false;
      const { points, stations } = course(scene, solved, cable, this.#holeToHole, slack);
      const radius = CABLE * scene.length * (slack ? 0.6 : 1);
      this.#cables[k]!.update(ringsAlong(points, radius), stations.map((station) => paint.cable(k, station)));
    });
    scene.disks.forEach((disk, i) => {
      const mesh = this.#disks[i]!;
      const [w, x, y, z] = solved.orientations[disk.station]!;
      mesh.position.set(...solved.positions[disk.station]!);
      mesh.setRotationFromQuaternion(new Turn(x, y, z, w));
      mesh.material.color.setRGB(...linear(paint.disk(i)));
    });
  }

  /** Greyed: the shape is not the answer to what the sliders say. */
  get stale(): boolean {
    return this.#stale;
  }

  set stale(stale: boolean) {
    this.#stale = stale;
    for (const material of this.#materials) {
      const { opacity, vertexColors } = material.userData as { opacity: number; vertexColors: boolean };
      material.opacity = stale ? 0.35 : opacity;
      material.transparent = material.opacity < 1;
      material.depthWrite = !stale;
      if (material.vertexColors !== (vertexColors && !stale)) {
        material.vertexColors = vertexColors && !stale;
        material.needsUpdate = true;
      }
      if (stale) material.color.setRGB(...linear(GREY));
      else if (vertexColors) material.color.set("#ffffff");
    }
  }

  dispose(): void {
    this.#backbone.dispose();
    for (const tube of this.#cables) tube.dispose();
    for (const disk of this.#disks) disk.geometry.dispose();
    for (const material of this.#materials as Material[]) material.dispose();
  }

  #material(options: MeshStandardMaterialParameters): Surface {
    const material = surface({ metalness: 0.05, ...options });
    material.userData = { opacity: material.opacity, vertexColors: material.vertexColors };
    this.#materials.push(material);
    return material;
  }

  #ring(solved: Solved, station: number): Ring {
    const turn = solved.orientations[station]!;
    return {
      centre: solved.positions[station]!,
      u: rotate(turn, [1, 0, 0]),
      v: rotate(turn, [0, 1, 0]),
      half: halfExtents(this.#scene, station),
    };
  }
}

/** Half extents of the backbone's cross-section in m. */
export function halfExtents({ section, length }: Scene, station: number): [number, number] {
  switch (section.kind) {
    case "round":
      return [section.outer[station]! / 2, section.outer[station]! / 2];
    case "rectangle":
      return [section.width[station]! / 2, section.height[station]! / 2];
    case "unknown":
      return [(THIN * length) / 2, (THIN * length) / 2];
  }
}

function profile({ section }: Scene): { outline: Outline; inner: number } {
  switch (section.kind) {
    case "round":
      return { outline: circle(SIDES), inner: section.inner.at(-1)! / section.outer.at(-1)! };
    case "rectangle":
      return { outline: square(), inner: 0 };
    case "unknown":
      return { outline: circle(SIDES), inner: 0 };
  }
}

function round([x, y]: readonly [number, number], radius: number, sides: number): Vector2[] {
  return circle(sides).points.slice(1).map(([a, b]) => new Vector2(x + radius * a, y + radius * b));
}

function plate(disk: Disk): BufferGeometry {
  const shape = new Shape(round([0, 0], disk.radius, RIM_SIDES));
  shape.holes = disk.holes.map((centre) => new Path(round(centre, disk.hole_radius, HOLE_SIDES)));
  const geometry = new ExtrudeGeometry(shape, { depth: disk.thickness, bevelEnabled: false });
  return geometry.translate(0, 0, -disk.thickness / 2);
}

export const GREY: Rgb = parse(NEUTRAL);
