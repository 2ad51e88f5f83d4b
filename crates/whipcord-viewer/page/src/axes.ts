// Which way x, y and z point, beside the robot, in the frame that loads are given in.

import { ArrowHelper, Group, Quaternion as Turn, Vector3 } from "three";

import { add, loadFrame, rotate } from "./geometry";
import type { Label } from "./labels";
import type { Scene, Vector } from "./protocol";

/** Length of an axis, and how far from the base they stand, relative to the length of the robot. */
const LENGTH = 0.16;
const ASIDE = 0.3;

export function axes(scene: Scene, ink: string): { group: Group; labels: Label[] } {
  const group = new Group();
  const size = LENGTH * scene.length;
  const frame = loadFrame(scene);
  group.position.set(...scene.base.position);
  const [w, x, y, z] = frame;
  group.setRotationFromQuaternion(new Turn(x, y, z, w));
  // Not in the grid, whose lines would hide them.
  const corner: Vector = [-ASIDE * scene.length, -ASIDE * scene.length, 0.01 * scene.length];
  const labels = ([[1, 0, 0], [0, 1, 0], [0, 0, 1]] as const).map((along, k): Label => {
    group.add(new ArrowHelper(new Vector3(...along), new Vector3(...corner), size, ink, 0.25 * size, 0.14 * size));
    const tip = add(corner, [1.25 * size * along[0], 1.25 * size * along[1], 1.25 * size * along[2]]);
    return { text: "xyz"[k]!, at: add(scene.base.position, rotate(frame, tip)), weight: 0, colour: ink };
  });
  return { group, labels };
}
