// Looking through a calibrated camera: the projection of its lens without distortion, and its photograph behind the robot, of which the
// distortion is taken out.

import { BufferAttribute, BufferGeometry, DirectionalLight, Mesh, MeshBasicMaterial, PerspectiveCamera, Quaternion as Turn, SRGBColorSpace, Texture, Vector3 } from "three";

import type { Camera, Vector } from "./protocol";

/** Half a turn about x: a camera here looks along -z and has y up, and a calibrated one along z and y down. */
const OVER = new Turn(1, 0, 0, 0);

export class Eye {
  readonly seen: Camera;
  readonly camera = new PerspectiveCamera();
  /** Distances that are drawn, in m. */
  readonly #near: number;
  readonly #far: number;
  /** Pixels of the view for each of the picture. */
  #ratio = 1;

  /** For a robot of this length at this place. */
  constructor(seen: Camera, length: number, at: Vector) {
    this.seen = seen;
    const { position, orientation: [w, x, y, z] } = seen.pose;
    this.camera.position.set(...position);
    this.camera.quaternion.set(x, y, z, w).multiply(OVER);
    this.camera.add(new DirectionalLight("#ffffff", 0.8));
    this.camera.matrixWorldAutoUpdate = true;
    this.camera.updateMatrixWorld();
    const away = this.camera.position.distanceTo(new Vector3(...at));
    const parallel = seen.lens.kind === "orthographic";
    [this.#near, this.#far] = [parallel ? -away - 4 * length : 0.01 * length, away + 4 * length];
  }

  /** All of the picture in a view of this size. */
  resize(width: number, height: number): void {
    const { lens, size } = this.seen;
    const ratio = (this.#ratio = Math.min(width / size[0], height / size[1]));
    // The picture is in the middle of the view, and begins half a pixel before the centre of its first pixel.
    const left = (width - ratio * size[0]) / 2 + 0.5 * ratio;
    const top = (height - ratio * size[1]) / 2 + 0.5 * ratio;
    const [near, far] = [this.#near, this.#far];
    const [cx, cy] = [(2 * (left + ratio * lens.centre[0])) / width - 1, 1 - (2 * (top + ratio * lens.centre[1])) / height];
    const { projectionMatrix } = this.camera;
    if (lens.kind === "pinhole") {
      const [fx, fy] = [(2 * ratio * lens.focal[0]) / width, (2 * ratio * lens.focal[1]) / height];
      projectionMatrix.set(fx, 0, -cx, 0, 0, fy, -cy, 0, 0, 0, -(far + near) / (far - near), (-2 * far * near) / (far - near), 0, 0, -1, 0);
    } else {
      const [sx, sy] = [(2 * ratio * lens.scale) / width, (2 * ratio * lens.scale) / height];
      projectionMatrix.set(sx, 0, 0, cx, 0, sy, 0, cy, 0, 0, -2 / (far - near), -(far + near) / (far - near), 0, 0, 0, 1);
    }
    this.camera.projectionMatrixInverse.copy(projectionMatrix).invert();
  }

  /** Pixels of the view for each metre at a place. */
  scaleAt(at: Vector3): number {
    const { lens } = this.seen;
    if (lens.kind === "orthographic") return this.#ratio * lens.scale;
    const way = this.camera.getWorldDirection(new Vector3());
    return (this.#ratio * lens.focal[1]) / Math.max(at.clone().sub(this.camera.position).dot(way), 1e-9);
  }

  /** A photograph behind all that is drawn: each place of it where the lens without distortion would have it. */
  photograph(picture: TexImageSource & { width: number; height: number }): Mesh {
    const { ideal, columns, lens } = this.seen;
    const rows = ideal.length / columns;
    const depth = this.#far * 0.999;
    const positions = new Float32Array(3 * ideal.length);
    const places = new Float32Array(2 * ideal.length);
    ideal.forEach((place, k) => {
      const [u, v] = place ?? [0, 0];
      const [x, y] =
        lens.kind === "pinhole"
          ? [(depth * (u - lens.centre[0])) / lens.focal[0], (depth * (v - lens.centre[1])) / lens.focal[1]]
          : [(u - lens.centre[0]) / lens.scale, (v - lens.centre[1]) / lens.scale];
      positions.set([x, -y, -depth], 3 * k);
      places.set([(k % columns) / (columns - 1), 1 - Math.floor(k / columns) / (rows - 1)], 2 * k);
    });
    const triangles: number[] = [];
    for (let row = 0; row + 1 < rows; row++) {
      for (let column = 0; column + 1 < columns; column++) {
        const a = row * columns + column;
        const [b, c, d] = [a + 1, a + columns, a + columns + 1];
        // Where the distortion has no inverse the picture has a hole.
        if ([a, b, c, d].every((k) => ideal[k] !== null)) triangles.push(a, c, b, b, c, d);
      }
    }
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(positions, 3));
    geometry.setAttribute("uv", new BufferAttribute(places, 2));
    geometry.setIndex(triangles);
    const texture = new Texture(picture as HTMLImageElement);
    texture.colorSpace = SRGBColorSpace;
    texture.needsUpdate = true;
    const mesh = new Mesh(geometry, new MeshBasicMaterial({ map: texture, depthTest: false, depthWrite: false, toneMapped: false }));
    mesh.name = "photograph";
    mesh.renderOrder = -10;
    mesh.frustumCulled = false;
    mesh.position.copy(this.camera.position);
    mesh.quaternion.copy(this.camera.quaternion);
    return mesh;
  }
}
