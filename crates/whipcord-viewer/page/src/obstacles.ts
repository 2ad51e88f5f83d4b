// What stands in the robot's way, and where it touches.

import {
  BackSide,
  BoxGeometry,
  BufferAttribute,
  BufferGeometry,
  CapsuleGeometry,
  CatmullRomCurve3,
  CylinderGeometry,
  DoubleSide,
  EdgesGeometry,
  FrontSide,
  Group,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  MeshLambertMaterial,
  PlaneGeometry,
  Quaternion as Turn,
  SphereGeometry,
  TubeGeometry,
  Vector3,
} from "three";

import { rotate } from "./geometry";
import type { Form, Scene } from "./protocol";

const COLOUR = "#a08f73";
/** Edge of the part of a half-space that is shown, relative to the length of the robot. */
const PART = 1.7;

export function obstacles(scene: Scene): Group {
  const group = new Group();
  for (const obstacle of scene.obstacles) {
    const open = obstacle.form.kind === "pipe" || obstacle.form.kind === "half_space";
    // Of closed bodies only the outside is seen, and of open ones both sides are drawn at once: half of the work.
    const material = new MeshLambertMaterial({
      color: COLOUR,
      transparent: true,
      opacity: open ? 0.25 : 0.6,
      side: open ? DoubleSide : FrontSide,
      forceSinglePass: true,
      depthWrite: !open,
    });
    const mesh = new Mesh(geometry(obstacle.form, scene.length), material);
    const [w, x, y, z] = obstacle.pose.orientation;
    mesh.position.set(...obstacle.pose.position);
    mesh.setRotationFromQuaternion(new Turn(x, y, z, w));
    mesh.name = obstacle.name;
    if (obstacle.form.kind === "half_space") {
      // Of what has no end a part is shown that is beside the robot.
      const middle = new Vector3(...scene.base.position).add(new Vector3(...rotate(scene.base.orientation, [0, 0, scene.length / 2])));
      mesh.updateMatrixWorld();
      const { x, y } = mesh.worldToLocal(middle);
      mesh.geometry.translate(x, y, 0);
      // Who looks out of it sees what is in front of it.
      material.side = FrontSide;
      const inside = new MeshLambertMaterial({ color: COLOUR, transparent: true, opacity: 0.08, side: BackSide, depthWrite: false });
      mesh.add(new Mesh(mesh.geometry, inside), new LineSegments(new EdgesGeometry(mesh.geometry), new LineBasicMaterial({ color: COLOUR })));
    }
    group.add(mesh);
  }
  return group;
}

function geometry(form: Form, length: number): BufferGeometry {
  switch (form.kind) {
    case "half_space":
      return new PlaneGeometry(PART * length, PART * length);
    case "sphere":
      return new SphereGeometry(form.radius, 48, 24);
    // three.js lays both along y.
    case "capsule":
      return new CapsuleGeometry(form.radius, form.length, 12, 32).rotateX(Math.PI / 2);
    case "cylinder":
      return new CylinderGeometry(form.radius, form.radius, form.length, 48).rotateX(Math.PI / 2);
    case "box":
      return new BoxGeometry(...form.size);
    case "pipe": {
      const points = form.middle.map((p) => new Vector3(...p));
      // Its own points are dense where it bends: the curve between them may be any.
      const curve = new CatmullRomCurve3(points, false, "centripetal");
      return new TubeGeometry(curve, Math.max(64, 2 * points.length), form.radius, 32, false);
    }
    case "superellipsoid":
      return superellipsoid(form.semi_axes, form.exponents);
    case "mesh": {
      const body = new BufferGeometry();
      body.setAttribute("position", new BufferAttribute(new Float32Array(form.vertices.flat()), 3));
      body.setIndex(form.triangles.flat());
      // Corners apart, so that edges look like edges.
      const flat = body.toNonIndexed();
      flat.computeVertexNormals();
      return flat;
    }
  }
}

function superellipsoid(axes: readonly number[], [e1, e2]: readonly [number, number]): BufferGeometry {
  const body = new SphereGeometry(1, 64, 48);
  const position = body.getAttribute("position") as BufferAttribute;
  const power = (x: number, e: number): number => Math.sign(x) * Math.abs(x) ** e;
  for (let i = 0; i < position.count; i++) {
    const [x, y, z] = [position.getX(i), position.getY(i), position.getZ(i)];
    const across = Math.hypot(x, y);
    const [c, s] = across > 0 ? [x / across, y / across] : [1, 0];
    const ring = power(across, e1);
    position.setXYZ(i, axes[0]! * ring * power(c, e2), axes[1]! * ring * power(s, e2), axes[2]! * power(z, e1));
  }
  body.computeVertexNormals();
  return body;
}
