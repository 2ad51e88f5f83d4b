// How the tip yields, as an ellipsoid: a force of 1 N in any direction moves the tip to its surface.

import { Matrix4, Mesh, MeshStandardMaterial, SphereGeometry, Vector3 } from "three";

import type { Compliance, Scene, Vector } from "./protocol";

/** The greatest half axis, relative to the length of the robot. The picture is of directions: numbers stand beside it. */
const SIZE = 0.2;
/** Half axes less than this, relative to the longest that is drawn, are drawn so: a flat body is hard to see. */
const LEAST = 0.02;

/** `most` is the compliance that is drawn as the greatest half axis: that of all models that are shown. */
export function ellipsoid(compliance: Compliance, most: number, at: Vector, scene: Scene, colour: string): Mesh | undefined {
  if (compliance.status !== "known" || most <= 0) return undefined;
  const [a, b, c] = compliance.values.map((value) => SIZE * scene.length * Math.max(value / most, LEAST)) as Vector;
  const [u, v, w] = compliance.directions.map((direction) => new Vector3(...direction)) as [Vector3, Vector3, Vector3];
  // Directions of either sign are principal ones; those of a rotation keep the surface outside.
  if (u.clone().cross(v).dot(w) < 0) w.negate();
  const material = new MeshStandardMaterial({ color: colour, transparent: true, opacity: 0.3, depthWrite: false });
  const body = new Mesh(new SphereGeometry(1, 40, 24), material);
  body.matrixAutoUpdate = false;
  body.matrix = new Matrix4().makeBasis(u, v, w).scale(new Vector3(a, b, c)).setPosition(...at);
  return body;
}
