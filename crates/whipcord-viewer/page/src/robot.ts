// One robot in space: backbone, disks and cables in the shape that a model found.

import { Color, Group, Matrix4, Mesh, Quaternion as Turn, Vector3, type MeshStandardMaterialParameters } from "three";

import { linear, parse, type Rgb } from "./colours";
import { Disks } from "./disks";
import { course, rotate } from "./geometry";
import { NEUTRAL } from "./legend";
import { COARSE, FINE, plate } from "./plate";
import type { Scene, Solved } from "./protocol";
import { drawsBySoftware } from "./sharpness";
import { surface, type Surface } from "./surface";
import { circle, ringsAlong, square, Tubes, type Course, type Profile, type Ring } from "./tube";

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
const TUBE: MeshStandardMaterialParameters = { vertexColors: true, roughness: 0.55 };
const DISK: MeshStandardMaterialParameters = { roughness: 0.8, transparent: true, opacity: 0.82 };
const ONE = new Vector3(1, 1, 1);
const WHITE: Rgb = [1, 1, 1];

/** What is drawn of a robot. */
export class Drawn extends Group {
  readonly #parts: () => Group;
  readonly #pieces: () => readonly { detail(coarsely: boolean): boolean }[];

  constructor(parts: () => Group, pieces: () => readonly { detail(coarsely: boolean): boolean }[]) {
    super();
    [this.#parts, this.#pieces] = [parts, pieces];
  }

  /** Whether pictures of what moves are coarser, and whether this changes something. */
  detail(coarsely: boolean): boolean {
    return this.#pieces().map((piece) => piece.detail(coarsely)).includes(true);
  }

  /** The robot in bodies of their own, each with its name: for what else is to have them. */
  parts(): Group {
    return this.#parts();
  }
}

export class RobotMesh {
  readonly group = new Drawn(() => this.#parts(), () => (drawsBySoftware() ? [this.#tubes, ...this.#disks.map(({ disks }) => disks)] : []));
  readonly #scene: Scene;
  readonly #profiles: Profile[];
  readonly #tubes: Tubes;
  readonly #disks: { disks: Disks; numbers: number[] }[];
  readonly #materials: Surface[] = [];
  readonly #tubesMaterial: Surface;
  readonly #holeToHole: boolean;
  #courses: readonly Course[] = [];
  #poses: readonly Matrix4[] = [];
  #diskColours: readonly Rgb[] = [];
  #stale = false;

  constructor(scene: Scene, model: string) {
    this.#scene = scene;
    this.#holeToHole = scene.models.find((choice) => choice.name === model)?.hole_to_hole ?? false;
    this.#profiles = [profile(scene), ...scene.cables.map(() => ({ outline: circle(CABLE_SIDES), inner: 0 }))];
    this.#tubes = new Tubes(this.#profiles);
    this.group.name = model;
    this.#tubesMaterial = this.#material(TUBE);
    const tubes = new Mesh(this.#tubes.geometry, this.#tubesMaterial);
    tubes.frustumCulled = false;
    const kinds = new Map<string, number[]>();
    scene.disks.forEach((disk, i) => {
      const key = JSON.stringify([disk.radius, disk.thickness, disk.hole_radius, disk.holes]);
      kinds.set(key, [...(kinds.get(key) ?? []), i]);
    });
    this.#disks = [...kinds.values()].map((numbers) => {
      const disk = scene.disks[numbers[0]!]!;
      return { disks: new Disks(plate(disk, FINE), plate(disk, COARSE), this.#material(DISK), numbers.length), numbers };
    });
    this.group.add(tubes, ...this.#disks.map(({ disks }) => disks));
  }

  update(solved: Solved, paint: Paint): void {
    const scene = this.#scene;
    this.#courses = [
      { rings: scene.stations.map((_, i) => this.#ring(solved, i)), colours: scene.stations.map((_, i) => paint.backbone(i)) },
      ...scene.cables.map((cable, k): Course => {
        const slack = solved.cables[k]?.slack ?? false;
        const { points, stations } = course(scene, solved, cable, this.#holeToHole, slack);
        const radius = CABLE * scene.length * (slack ? 0.6 : 1);
        return { rings: ringsAlong(points, radius), colours: stations.map((station) => paint.cable(k, station)) };
      }),
    ];
    this.#tubes.update(this.#courses);
    this.#poses = scene.disks.map(({ station }) => {
      const [w, x, y, z] = solved.orientations[station]!;
      return new Matrix4().compose(new Vector3(...solved.positions[station]!), new Turn(x, y, z, w), ONE);
    });
    this.#diskColours = scene.disks.map((_, i) => paint.disk(i));
    this.#paintDisks();
  }

  #paintDisks(): void {
    const grey = new Color(...linear(GREY));
    for (const { disks, numbers } of this.#disks) {
      numbers.forEach((number, i) => disks.put(i, this.#poses[number]!, this.#stale ? grey : new Color(...linear(this.#diskColours[number]!))));
      disks.update();
    }
  }

  #parts(): Group {
    const made = new Group();
    made.name = this.group.name;
    this.#profiles.forEach((each, i) => {
      const tube = new Tubes([each]);
      tube.update([this.#courses[i]!]);
      const mesh = new Mesh(tube.geometry, this.#tubesMaterial);
      mesh.name = i === 0 ? "backbone" : `cable ${this.#scene.cables[i - 1]!.name}`;
      made.add(mesh);
    });
    for (const { disks, numbers } of this.#disks) {
      const body = plate(this.#scene.disks[numbers[0]!]!, FINE);
      for (const number of numbers) {
        const material = disks.material.clone();
        material.color.setRGB(...linear(this.#stale ? GREY : this.#diskColours[number]!));
        const mesh = new Mesh(body, material);
        mesh.name = `disk ${number + 1}`;
        this.#poses[number]!.decompose(mesh.position, mesh.quaternion, mesh.scale);
        made.add(mesh);
      }
    }
    return made;
  }

  /** Greyed: the shape is not the answer to what the sliders say. */
  get stale(): boolean {
    return this.#stale;
  }

  set stale(stale: boolean) {
    if (stale !== this.#stale) {
      this.#stale = stale;
      if (this.#poses.length > 0) this.#paintDisks();
    }
    for (const material of this.#materials) {
      const { opacity, vertexColors } = material.userData as { opacity: number; vertexColors: boolean };
      material.opacity = stale ? 0.35 : opacity;
      material.transparent = material.opacity < 1;
      material.depthWrite = !stale;
      if (material.vertexColors !== (vertexColors && !stale)) {
        material.vertexColors = vertexColors && !stale;
        material.needsUpdate = true;
      }
      if (vertexColors) material.color.setRGB(...linear(stale ? GREY : WHITE));
    }
  }

  dispose(): void {
    this.#tubes.dispose();
    this.#tubesMaterial.dispose();
    for (const { disks } of this.#disks) disks.dispose();
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

function profile({ section }: Scene): Profile {
  switch (section.kind) {
    case "round":
      return { outline: circle(SIDES), inner: section.inner.at(-1)! / section.outer.at(-1)! };
    case "rectangle":
      return { outline: square(), inner: 0 };
    case "unknown":
      return { outline: circle(SIDES), inner: 0 };
  }
}

export const GREY: Rgb = parse(NEUTRAL);
