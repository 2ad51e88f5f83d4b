// Which way x, y and z point, beside the robot, in the frame that loads are given in.

import { ArrowHelper, CanvasTexture, Group, Quaternion as Turn, Sprite, SpriteMaterial, Vector3 } from "three";

import type { Scene } from "./protocol";

/** Length of an axis, and how far from the base they stand, relative to the length of the robot. */
const LENGTH = 0.16;
const ASIDE = 0.3;
/** Height of a letter, relative to an axis, and in pixels before it is drawn. */
const LETTER = 0.35;
const PIXELS = 64;

export function axes(scene: Scene, ink: string): Group {
  const group = new Group();
  const size = LENGTH * scene.length;
  group.position.set(...scene.base.position);
  const [w, x, y, z] = scene.loads_in_base ? scene.base.orientation : [1, 0, 0, 0];
  group.setRotationFromQuaternion(new Turn(x, y, z, w));
  // Not in the grid, whose lines would hide them.
  const corner = new Vector3(-ASIDE, -ASIDE, 0.01).multiplyScalar(scene.length);
  [new Vector3(1, 0, 0), new Vector3(0, 1, 0), new Vector3(0, 0, 1)].forEach((along, k) => {
    const letter = letters("xyz"[k]!, ink);
    letter.scale.setScalar(LETTER * size);
    letter.position.copy(corner).addScaledVector(along, 1.25 * size);
    group.add(new ArrowHelper(along, corner, size, ink, 0.25 * size, 0.14 * size), letter);
  });
  return group;
}

function letters(text: string, ink: string): Sprite {
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [PIXELS, PIXELS];
  const context = canvas.getContext("2d");
  if (context) {
    context.font = `${0.8 * PIXELS}px system-ui, "Liberation Sans", "DejaVu Sans", sans-serif`;
    [context.textAlign, context.textBaseline, context.fillStyle] = ["center", "middle", ink];
    context.fillText(text, PIXELS / 2, PIXELS / 2);
  }
  return new Sprite(new SpriteMaterial({ map: new CanvasTexture(canvas), depthWrite: false, toneMapped: false }));
}
