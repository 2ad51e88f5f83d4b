// Pictures for papers: at a chosen size and resolution, as PNG or SVG, without what only the page needs.

import { AmbientLight, Color, DirectionalLight, type Object3D, type Scene } from "three";
import { SVGRenderer } from "three/addons/renderers/SVGRenderer.js";

import { coloursOf, stamp, type Legend } from "./legend";
import { scaleBar } from "./scale";
import type { Stage } from "./stage";
import { significant } from "./units";

export interface PictureOptions {
  format: "png" | "svg";
  /** In mm on paper. */
  width: number;
  height: number;
  /** Pixels for each inch. */
  resolution: number;
  transparent: boolean;
  grid: boolean;
  labels: boolean;
  bar: boolean;
}

export interface Said {
  legend: Legend | undefined;
  ink: string;
}

const INCH = 25.4;
/** Height of letters on paper in mm. */
const LETTERS = 2.8;
/** Most pixels along an edge that browsers draw. */
const MOST = 8192;

/** Of a picture in pixels. */
export function pixels({ width, height, resolution }: PictureOptions): [number, number] {
  const size: [number, number] = [Math.round((width / INCH) * resolution), Math.round((height / INCH) * resolution)];
  if (!size.every((edge) => edge >= 16 && edge <= MOST)) {
    throw new Error(`a picture has 16 to ${MOST} pixels along each edge, and this would have ${size[0]} × ${size[1]}: change its size or resolution`);
  }
  return size;
}

export async function picture(stage: Stage, options: PictureOptions, said: Said): Promise<Blob> {
  return options.format === "png" ? png(stage, options, said) : svg(stage, options, said);
}

async function png(stage: Stage, options: PictureOptions, said: Said): Promise<Blob> {
  const [width, height] = pixels(options);
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [width, height];
  const context = canvas.getContext("2d");
  if (!context) throw new Error("this browser draws no pictures");
  // Pixels of the picture for those of a page in which letters have 13.
  const ratio = ((LETTERS / INCH) * options.resolution) / 13;
  // Drawn larger where that goes, so that edges are smooth.
  const finer = Math.max(width, height) <= MOST / 4 ? 2 : 1;
  context.imageSmoothingQuality = "high";
  stage.picture(finer * width, finer * height, options, () => {
    stage.renderer.render(stage.space, stage.cameras.camera);
    context.drawImage(stage.canvas, 0, 0, width, height);
    if (options.labels) write(context, stage, ratio, said.ink);
    if (options.bar) {
      const { pixels: long, words } = scaleBar(stage.cameras.scale(height), 0.25 * width);
      const [x, y] = [12 * ratio, height - 14 * ratio];
      context.strokeStyle = context.fillStyle = said.ink;
      context.lineWidth = 2 * ratio;
      context.beginPath();
      for (const [a, b] of [[x, y - 4 * ratio], [x, y], [x + long, y], [x + long, y - 4 * ratio]] as const) context.lineTo(a, b);
      context.stroke();
      context.font = font(ratio);
      [context.textAlign, context.textBaseline] = ["center", "bottom"];
      context.fillText(words, x + long / 2, y - 5 * ratio);
    }
  });
  if (said.legend && options.labels) {
    context.save();
    context.translate(0, options.bar ? -34 * ratio : 0);
    context.textAlign = "left";
    stamp(context, said.legend, ratio, said.ink);
    context.restore();
  }
  const blob = await new Promise<Blob | null>((done) => canvas.toBlob(done, "image/png"));
  if (!blob) throw new Error("this browser makes no PNG of it");
  return new Blob([withResolution(new Uint8Array(await blob.arrayBuffer()), options.resolution) as BlobPart], { type: "image/png" });
}

const FAMILY = 'system-ui, "Liberation Sans", "DejaVu Sans", sans-serif';

function font(ratio: number): string {
  return `${13 * ratio}px ${FAMILY}`;
}

function write(context: CanvasRenderingContext2D, stage: Stage, ratio: number, ink: string): void {
  const { width, height } = context.canvas;
  // At the size that they have in a page of so many pixels.
  const size = { width: width / ratio, height: height / ratio };
  context.font = font(ratio);
  [context.textAlign, context.textBaseline] = ["center", "middle"];
  for (const { text, colour, x, y } of stage.labels.words(stage.cameras.camera, size)) {
    context.fillStyle = colour || ink;
    context.fillText(text, x * ratio, y * ratio);
  }
}

/** A PNG that says how many pixels for each inch it has: a chunk pHYs behind the first. */
export function withResolution(png: Uint8Array, resolution: number): Uint8Array {
  const perMetre = Math.round((resolution / INCH) * 1e3);
  const chunk = new Uint8Array(21);
  const view = new DataView(chunk.buffer);
  view.setUint32(0, 9);
  chunk.set([0x70, 0x48, 0x59, 0x73], 4);
  view.setUint32(8, perMetre);
  view.setUint32(12, perMetre);
  chunk[16] = 1;
  view.setUint32(17, checksum(chunk.subarray(4, 17)));
  // Signature of 8 bytes, and the first chunk with 13 of its own.
  const behind = 8 + 25;
  const made = new Uint8Array(png.length + chunk.length);
  made.set(png.subarray(0, behind));
  made.set(chunk, behind);
  made.set(png.subarray(behind), behind + chunk.length);
  return made;
}

/** CRC-32 as PNG has it. */
function checksum(bytes: Uint8Array): number {
  let crc = 0xffffffff;
  for (const byte of bytes) {
    crc ^= byte;
    for (let k = 0; k < 8; k++) crc = crc & 1 ? (crc >>> 1) ^ 0xedb88320 : crc >>> 1;
  }
  return (crc ^ 0xffffffff) >>> 0;
}

/** Bodies as shaded polygons, words and bar as text. */
function svg(stage: Stage, options: PictureOptions, said: Said): Blob {
  const scale = 96 / INCH;
  const [width, height] = [options.width * scale, options.height * scale];
  const renderer = new SVGRenderer();
  renderer.setSize(width, height);
  renderer.setPrecision(2);
  renderer.setQuality("low");
  const { camera } = stage.cameras;
  // What is hidden is not drawn, and lines of a width only cards draw: they have no polygons.
  const hidden: Object3D[] = [];
  stage.space.traverse((object) => {
    if (object.visible && ((object as { isLine2?: boolean }).isLine2 || (object as { isSprite?: boolean }).isSprite)) hidden.push(object);
  });
  const parts = stage.picture(16, Math.round((16 * height) / width), options, () => {
    stage.cameras.resize(width, height);
    for (const object of hidden) object.visible = false;
    renderer.setClearColor(new Color("#ffffff"), 0);
    const { background } = stage.space;
    stage.space.background = null;
    const back = dim(stage.space);
    try {
      stage.apart(() => renderer.render(stage.space, camera));
    } finally {
      back();
      stage.space.background = background;
      for (const object of hidden) object.visible = true;
    }
    const ratio = (LETTERS * scale) / 13;
    const size = { width: width / ratio, height: height / ratio };
    const words = options.labels ? stage.labels.words(camera, size) : [];
    const bar = options.bar ? scaleBar(stage.cameras.scale(height), 0.25 * width) : undefined;
    return { ratio, words, bar };
  });
  const { ratio, words, bar } = parts;
  const paths = [...renderer.domElement.childNodes]
    .map((node) => new XMLSerializer().serializeToString(node).replace(' xmlns="http://www.w3.org/2000/svg"', ""))
    // Neighbours meet without a gap, and transparent ones do not overlap.
    .map((path) => (/fill-opacity:0|fill-opacity:1e/.test(path) ? path : path.replace(' shape-rendering="crispEdges"', "")))
    .map((path) => path.replace(/fill:(rgb\([^)]*\));fill-opacity:1"/, 'fill:$1;stroke:$1;stroke-width:0.15"'))
    .join("\n");
  const centred = `${round(-width / 2)} ${round(-height / 2)} ${round(width)} ${round(height)}`;
  const text = (x: number, y: number, word: string, colour: string): string =>
    `<text x="${round(x - width / 2)}" y="${round(y - height / 2)}" fill="${colour}" text-anchor="middle" dominant-baseline="middle">${escaped(word)}</text>`;
  const lines = [
    `<svg xmlns="http://www.w3.org/2000/svg" width="${options.width}mm" height="${options.height}mm" viewBox="${centred}" font-family="Liberation Sans, DejaVu Sans, sans-serif" font-size="${round(13 * ratio)}">`,
    ...(options.transparent ? [] : [`<rect x="${round(-width / 2)}" y="${round(-height / 2)}" width="${round(width)}" height="${round(height)}" fill="#ffffff"/>`]),
    `<g>${paths}</g>`,
    ...words.map(({ text: word, colour, x, y }) => text(x * ratio, y * ratio, word, colour)),
  ];
  if (bar) {
    const [x, y] = [12 * ratio, height - 14 * ratio];
    const points = [[x, y - 4 * ratio], [x, y], [x + bar.pixels, y], [x + bar.pixels, y - 4 * ratio]];
    const path = points.map(([a, b]) => `${round(a! - width / 2)},${round(b! - height / 2)}`).join(" ");
    lines.push(`<polyline points="${path}" fill="none" stroke="${said.ink}" stroke-width="${round(2 * ratio)}"/>`, text(x + bar.pixels / 2, y - 12 * ratio, bar.words, said.ink));
  }
  if (said.legend && options.labels) lines.push(legendMarkup(said.legend, said.ink, ratio, [-width / 2 + 12 * ratio, height / 2 - (options.bar ? 48 : 20) * ratio]));
  lines.push("</svg>");
  return new Blob([lines.join("\n")], { type: "image/svg+xml" });
}

/** Light as these polygons take it: a card divides it by π, and knows light from the sky, which here comes from everywhere. Puts it back. */
function dim(space: Scene): () => void {
  const everywhere = new AmbientLight(new Color(0.38, 0.38, 0.4));
  const lights: DirectionalLight[] = [];
  space.traverse((object) => {
    if (object instanceof DirectionalLight) lights.push(object);
  });
  for (const light of lights) light.intensity /= Math.PI;
  space.add(everywhere);
  return () => {
    for (const light of lights) light.intensity *= Math.PI;
    space.remove(everywhere);
  };
}

function round(value: number): string {
  return String(Number(value.toFixed(2)));
}

/** A legend from this place on, to the right. */
function legendMarkup(legend: Legend, ink: string, ratio: number, [left, middle]: readonly [number, number]): string {
  const size = 12 * ratio;
  const parts: string[] = [];
  let x = left;
  const say = (words: string): void => {
    parts.push(`<text x="${round(x)}" y="${round(middle)}" fill="${ink}" dominant-baseline="middle">${escaped(words)}</text>`);
    x += (words.length * 7 + 10) * ratio;
  };
  const block = (fill: string, width: number): void => {
    parts.push(`<rect x="${round(x)}" y="${round(middle - size / 2)}" width="${round(width)}" height="${round(size)}" fill="${fill}"/>`);
    x += width + 6 * ratio;
  };
  if ("keys" in legend) {
    for (const { colour, label } of legend.keys) {
      block(colour, size);
      say(label);
    }
    return parts.join("\n");
  }
  const colours = coloursOf(legend);
  const stops = colours.map((colour, i) => `<stop offset="${round(i / (colours.length - 1))}" stop-color="${colour}"/>`).join("");
  parts.push(`<defs><linearGradient id="ramp">${stops}</linearGradient></defs>`);
  say(`${legend.title} in ${legend.unit}`);
  say(significant(legend.least, 3));
  block("url(#ramp)", 9 * size);
  say(significant(legend.most, 3));
  return parts.join("\n");
}

function escaped(words: string): string {
  return words.replace(/[&<>]/g, (letter) => ({ "&": "&amp;", "<": "&lt;", ">": "&gt;" })[letter]!);
}
