// The body of a disk: a plate with holes, and a coarser one for pictures that a processor draws while something moves.

import { BufferGeometry, Float32BufferAttribute, Path, Shape, ShapeGeometry, Vector2 } from "three";

import type { Disk } from "./protocol";
import { circle } from "./tube";

export interface Detail {
  /** Sides of the polygons that stand for the rim and for a hole. */
  rim: number;
  /** None: without holes. */
  hole: number | undefined;
}

export const FINE: Detail = { rim: 48, hole: 12 };
export const COARSE: Detail = { rim: 20, hole: undefined };

function round([x, y]: readonly [number, number], radius: number, sides: number): Vector2[] {
  return circle(sides).points.slice(1).map(([a, b]) => new Vector2(x + radius * a, y + radius * b));
}

/** The plate about its middle, its axis along z. */
export function plate({ radius, thickness, holes: all, hole_radius }: Disk, { rim, hole = 0 }: Detail): BufferGeometry {
  const holes = hole > 0 ? all : [];
  const shape = new Shape(round([0, 0], radius, rim));
  shape.holes = holes.map((centre) => new Path(round(centre, hole_radius, hole)));
  const face = new ShapeGeometry(shape);
  const flat = face.getAttribute("position");
  const triangles = face.getIndex()!.array;
  const [position, normal, index]: [number[], number[], number[]] = [[], [], []];
  const half = thickness / 2;
  for (const side of [1, -1]) {
    const from = position.length / 3;
    for (let i = 0; i < flat.count; i++) {
      position.push(flat.getX(i), flat.getY(i), side * half);
      normal.push(0, 0, side);
    }
    for (let t = 0; t < triangles.length; t += 3) {
      const [a, b, c] = [from + triangles[t]!, from + triangles[t + 1]!, from + triangles[t + 2]!];
      index.push(a, ...(side > 0 ? [b, c] : [c, b]));
    }
  }
  face.dispose();
  // `side` is −1 for a wall that is seen from its axis.
  const wall = ([x, y]: readonly [number, number], radius: number, sides: number, side: number): void => {
    const from = position.length / 3;
    circle(sides).points.forEach(([a, b], k) => {
      for (const z of [-half, half]) {
        position.push(x + radius * a, y + radius * b, z);
        normal.push(side * a, side * b, 0);
      }
      if (k === sides) return;
      const [low, high, nextLow, nextHigh] = [0, 1, 2, 3].map((i) => from + 2 * k + i) as [number, number, number, number];
      if (side > 0) index.push(low, nextLow, nextHigh, low, nextHigh, high);
      else index.push(low, nextHigh, nextLow, low, high, nextHigh);
    });
  };
  wall([0, 0], radius, rim, 1);
  for (const centre of holes) wall(centre, hole_radius, hole, -1);
  const made = new BufferGeometry();
  made.setAttribute("position", new Float32BufferAttribute(position, 3));
  made.setAttribute("normal", new Float32BufferAttribute(normal, 3));
  made.setIndex(index);
  return made;
}
