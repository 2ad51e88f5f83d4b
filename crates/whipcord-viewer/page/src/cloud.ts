// Where the tip can go, as a cloud of points, and what is said of it.

import { BufferGeometry, Float32BufferAttribute, Points, PointsMaterial } from "three";

import { linear, ramp } from "./colours";
import type { Cloud } from "./protocol";
import { significant } from "./units";

/** Size of a point, relative to a voxel. */
const SIZE = 0.45;

/** The points of a cloud, coloured by the least motion of the tip: near singular shapes they are dark. */
export function points({ points: places, dexterity, voxel }: Cloud): Points {
  const most = Math.max(...dexterity, Number.MIN_VALUE);
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new Float32BufferAttribute(places.flat(), 3));
  geometry.setAttribute("color", new Float32BufferAttribute(dexterity.flatMap((motion) => linear(ramp(motion / most))), 3));
  const material = new PointsMaterial({ size: SIZE * voxel, vertexColors: true, transparent: true, opacity: 0.55, depthWrite: false });
  return new Points(geometry, material);
}

/** How large the workspace is, and what its colours stand for. */
export function describe({ points: places, dexterity, dimension, measure, complete }: Cloud): string {
  const [scale, unit] = dimension === 3 ? [1e6, "cm³"] : dimension === 2 ? [1e4, "cm²"] : [1e3, "mm"];
  const size = `${significant(scale * measure, 3)} ${unit}`;
  const most = significant(1e3 * Math.max(...dexterity), 3);
  const rest = complete ? "" : " The survey ended before it found all: there may be more.";
  return (
    `${size}, ${places.length} points, under these loads. Bright where the least motion of the tip by commands is large (up to ` +
    `${most} mm for those that bend the robot by half a turn), dark near singular shapes.${rest}`
  );
}
