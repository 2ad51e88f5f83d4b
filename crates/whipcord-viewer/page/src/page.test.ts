import { Color } from "three";
import { describe, expect, it } from "vitest";

import { acting, loadsOf } from "./acting";
import { linear, modelColour, parse } from "./colours";
import { rootMeanSquare } from "./compare";
import { put } from "./holes";
import { course, place, rotate, strainsOf, tensions, tipFrame } from "./geometry";
import interpolation from "./interpolation.json";
import { pixels, withResolution } from "./picture";
import { around, contacts, move, objects, momentsOf } from "./recorded";
import { decode, encode, encodeDesign, encodePlay, encodeSurvey, type Command, type Pose, type Request, type Scene, type Solved, type Vector } from "./protocol";
import { fromPage, toPage } from "./samples";
import { scaleBar } from "./scale";
import { Sharpness } from "./sharpness";
import { along, csv, smooth } from "./sketch";
import { Spring } from "./spring";
import { fromHash, History, initialState, rebase, toHash, toRequest, viewFromHash, viewToHash } from "./state";
import { fixed, fromUnit, MILLIMETRE, significant, toUnit } from "./units";

const scene = toPage.find((message) => message.type === "scene")! as Scene;
const frame = toPage.find((message) => message.type === "frame")!;
const solved = (frame.type === "frame" ? frame.answers[0] : undefined) as Solved;

describe("the protocol", () => {
  it("is read as the server writes it", () => {
    for (const message of toPage) expect(decode(JSON.stringify(message))).toEqual(message);
    expect(() => decode('{"type":"other"}')).toThrow("unknown kind");
  });

  it("is written as the server reads it", () => {
    const [solve, survey, end, play, endPlay, design] = fromPage;
    const { type: _, ...request } = solve as { type: string } & Request;
    expect(JSON.parse(encode(request))).toEqual(solve);
    expect(JSON.parse(encodeSurvey(request))).toEqual(survey);
    expect(JSON.parse(encodeSurvey(undefined))).toEqual(end);
    expect(JSON.parse(encodePlay({ course: "motion", request }))).toEqual(play);
    expect(JSON.parse(encodePlay(undefined))).toEqual(endPlay);
    expect(JSON.parse(encodeDesign({ request, cable: 0, tension: true, places: [[0, 0, 0.2]] }))).toEqual(design);
  });
});

describe("a force at the tip", () => {
  it("is in the frame that the file says", () => {
    const tip = [Math.SQRT1_2, 0, Math.SQRT1_2, 0] as const;
    const world = (of: Partial<Scene>): number[] => [...rotate(tipFrame({ ...scene, ...of }, [...tip]), [0, 0, 1])];
    expect(world({ loads_in_base: false, tip_follower: false })).toEqual([0, 0, 1]);
    expect(tipFrame({ ...scene, loads_in_base: true, tip_follower: false }, [...tip])).toEqual(scene.base.orientation);
    // A tip that is turned about y by a right angle points along x.
    world({ loads_in_base: true, tip_follower: true }).forEach((c, i) => expect(c).toBeCloseTo([1, 0, 0][i]!, 12));
  });
});

describe("units", () => {
  it("turn back and forth without digits of rounding", () => {
    expect(toUnit(0.0123, MILLIMETRE)).toBe(12.3);
    expect(fromUnit(12.3, MILLIMETRE)).toBe(0.0123);
    expect(fromUnit(toUnit(-0.0017, MILLIMETRE), MILLIMETRE)).toBe(-0.0017);
  });

  it("are written for people", () => {
    expect(significant(1234.5678, 3)).toBe("1230");
    expect(significant(-0.5, 3)).toBe("−0.5");
    expect(significant(8.6e-13, 2)).toBe("8.6e−13");
    expect(fixed(-0.00001, 3)).toBe("0.000");
  });
});

describe("colours", () => {
  it("are given to three.js as it gives them itself", () => {
    for (const css of ["#0072b2", "#d55e00", "#000000", "#0a0a0a", "#ffffff"]) {
      const expected = new Color(css).toArray();
      linear(parse(css)).forEach((c, i) => expect(c).toBeCloseTo(expected[i]!, 6));
    }
  });

  it("of a variant are those of its model, lighter or darker", () => {
    expect(modelColour("four-bar")).toBe("#009e73");
    expect(modelColour("cosserat-disks")).toBe("#d55e00");
    expect(modelColour("four-bar-sliding")).toBe("#66c5ab");
    expect(modelColour("four-bar-strain-energy")).toBe("#005f45");
  });
});

describe("holes", () => {
  it("are kept beside those of the file where they are others", () => {
    const own = [[1, 1], null, [2, 2]];
    const changed = put(own, [], 2, [2, 3]);
    expect(changed).toEqual([null, null, [2, 3]]);
    expect(put(own, changed, 2, [2, 2])).toEqual([]);
  });
});

describe("a sketch", () => {
  it("has the places of the disks along its stroke, and goes straight on beyond", () => {
    const corner: [number, number][] = [[0, 0], [0, 0.1], [0, 0.1], [0.05, 0.1]];
    expect(along(corner, [0.05, 0.1, 0.12])).toEqual([[0, 0.05], [0, 0.1], [expect.closeTo(0.02, 12), 0.1]]);
    expect(along(corner, [0.2])).toEqual([[expect.closeTo(0.1, 12), 0.1]]);
  });

  it("loses the tremor of the hand, and keeps its ends", () => {
    const trembling = Array.from({ length: 41 }, (_, i): [number, number] => [i % 2 === 0 ? 0.001 : -0.001, 0.005 * i]);
    const calm = smooth(trembling);
    expect([calm[0], calm.at(-1)]).toEqual([trembling[0], trembling.at(-1)]);
    expect(Math.max(...calm.slice(10, 30).map(([u]) => Math.abs(u)))).toBeLessThan(1e-5);
  });

  it("is a table of the disks behind the base", () => {
    expect(csv([[0.01, 0, 0.1], [0.0123, -0.5, 0.2]])).toBe("disk,x [mm],y [mm],z [mm]\n2,10,0,100\n3,12.3,-500,200\n");
  });
});

describe("the state", () => {
  it("asks for what the file asks for", () => {
    expect(toRequest(initialState(scene), 7)).toEqual({ ...scene.initial, compliance: false, target: null, pull: null, holes: [] });
    expect(toRequest(initialState(scene), 7, [0, 0, 1]).target).toEqual([0, 0, 1]);
  });

  it("goes through the address and back", () => {
    const initial = initialState(scene);
    expect(toHash(initial, initial)).toBe("");
    const state = structuredClone(initial);
    state.commands = [{ shortening: -0.0031 }, { tension: 4.25 }, { motor: -0.5 }];
    state.tipForce = [0, -0.5, 1e-3];
    state.models = ["cosserat"];
    state.colouring = "curvature";
    [state.dragging, state.workspace] = ["reach", true];
    state.pull = { arc_length: 0.05, force: [0, -0.2, 0] };
    const hash = toHash(state, initial);
    expect(hash).toBe("cables=s-0.0031,t4.25,m-0.5&force=0,-0.5,0.001&models=cosserat&colour=curvature&drag=reach&pull=0.05,0,-0.2,0&workspace=true");
    expect(fromHash(`#${hash}`, scene)).toEqual(state);
    state.models = [];
    expect(fromHash(toHash(state, initial), scene)).toEqual(state);
    const disks = structuredClone(scene);
    disks.cables[0]!.holes = [1, 1];
    disks.disks = [0, 2].map((station) => ({ ...scene.disks[0]!, station, holes: [[0.008, 0], [0, 0.008]] }));
    state.holes = [[1, 2]];
    state.sketch = { across: "y", points: [[0.0125, 0.19]] };
    const designed = toHash(state, initialState(disks));
    expect(designed).toContain("holes=1-2&sketch=y,0.0125,0.19");
    expect(fromHash(designed, disks)).toEqual({ ...state, holes: [[1, 2]] });
    // A hole or a disk that the robot does not have.
    for (const other of ["holes=1-3", "holes=1", "holes=1-x", "sketch=z,0,0", "sketch=x,1", "sketch=x,1,2,3,4"]) {
      expect(fromHash(other, disks)).toEqual(initialState(disks));
    }
  });

  it("keeps what was moved, and nothing else, when the file changes", () => {
    const initial = initialState(scene);
    const moved = structuredClone(initial);
    moved.commands[1] = { tension: 4.25 };
    moved.tipForce[2] = 0.5;
    const changed = structuredClone(scene);
    changed.initial.commands[0] = { tension: 77 };
    changed.initial.tip_force = [0.1, 0.2, 0.3];
    const again = rebase(moved, initial, changed);
    expect(again.commands).toEqual([{ tension: 77 }, { tension: 4.25 }, { motor: 0.7 }]);
    expect(again.tipForce).toEqual([0.1, 0.2, 0.5]);
    const history = new History(initial);
    history.commit(moved);
    history.rebase((state) => rebase(state, initial, changed));
    expect(history.undo()).toEqual(initialState(changed));
    expect(history.redo()).toEqual(again);
    // The file now says what was moved to: there is nothing to undo.
    const same = structuredClone(scene);
    same.initial.commands[1] = { tension: 4.25 };
    same.initial.tip_force[2] = 0.5;
    const other = new History(initial);
    other.commit(moved);
    other.rebase((state) => rebase(state, initial, same));
    expect(other.canUndo).toBe(false);
  });

  it("has from where one looks", () => {
    const view = [0.1, -0.2, 0.3, 0, 0, 0.15];
    expect(viewFromHash(`#force=1,,&${viewToHash(view)}`)).toEqual(view);
    for (const hash of ["", "#view=1,2", "#view=1,2,3,4,5,x", "#review=1,2,3,4,5,6", "#view=0,0,0,0,0,0"]) expect(viewFromHash(hash)).toBeUndefined();
  });

  it("is that of the file where the address makes no sense", () => {
    const nonsense = "#cables=t1&force=1,2&moment=a,b,c&models=none&colour=pink&gravity=1,2,NaN&drag=away&workspace=1&%";
    for (const other of ["#cables=x1,t2,m1", "#cables=t1,t2", "#cables=m1,t2,m1", "#cables=t1,t2,s1"]) {
      expect(fromHash(other, scene)).toEqual(initialState(scene));
    }
    expect(fromHash(nonsense, scene)).toEqual(initialState(scene));
  });

  it("is undone and redone", () => {
    const first = initialState(scene);
    const history = new History(first);
    const second = { ...structuredClone(first), tipForce: [1, 0, 0] as [number, number, number] };
    history.commit(second);
    history.commit(structuredClone(second));
    expect(history.undo()).toEqual(first);
    expect(history.undo()).toBeUndefined();
    expect(history.redo()).toEqual(second);
    history.undo();
    history.commit({ ...first, models: [] });
    expect(history.canRedo).toBe(false);
  });
});

describe("geometry", () => {
  it("turns as quaternions do", () => {
    const quarter = Math.SQRT1_2;
    const turned = rotate([quarter, 0, 0, quarter], [1, 0, 0]);
    turned.forEach((c, i) => expect(c).toBeCloseTo([0, 1, 0][i]!, 15));
  });

  it("places cables in the cross-sections, and slack ones outside of their holes", () => {
    const flat: Scene = { ...scene, disks: [0, 2].map((station) => ({ ...scene.disks[0]!, station })) };
    const straight: Solved = {
      ...solved,
      positions: [[0, 0, 0], [0, 0, 0.1], [0, 0, 0.2]],
      orientations: [[1, 0, 0, 0], [1, 0, 0, 0], [1, 0, 0, 0]],
    };
    const cable = flat.cables[0]!;
    expect(place(straight, 1, [0.008, 0])).toEqual([0.008, 0, 0.1]);
    expect(course(flat, straight, cable, false, false).points).toHaveLength(3);
    expect(course(flat, straight, cable, true, false).stations).toEqual([0, 2]);
    const slack = course(flat, straight, cable, true, true);
    expect(slack.points[1]![0]).toBeGreaterThan(0.0081);
    expect(slack.points[2]![0]).toBeCloseTo(0.008, 15);
  });

  it("gives a cable that rubs the tension of each span", () => {
    const rubbing: Scene = { ...scene, disks: [0, 1, 2].map((station) => ({ ...scene.disks[0]!, station })) };
    expect(tensions(rubbing, solved, 0, [0, 1, 2])).toEqual([1.5, 1.5, 1.4]);
  });
});

describe("strains", () => {
  it("are means from disk to disk where a model bends at joints alone", () => {
    const models = [{ name: "linkage", hole_to_hole: false, jointed: true, refusal: null }];
    const linkage: Scene = { ...scene, models, stations: [0, 0.1, 0.4, 0.6], disks: [0, 2, 3].map((station) => ({ ...scene.disks[0]!, station })) };
    const bent: Solved = { ...solved, model: "linkage", strains: [[4, 0, 0, 0, 0, 0], [0, 0, 0, 0, 0, 0.1], [2, 0, 1, 0, 0, 0]] };
    const means = strainsOf(linkage, bent).map((strain) => strain.map((c) => Number(c.toPrecision(12))));
    expect(means).toEqual([[1, 0, 0, 0, 0, 0.075], [1, 0, 0, 0, 0, 0.075], [2, 0, 1, 0, 0, 0]]);
    expect(strainsOf(linkage, { ...bent, model: "cosserat" })).toEqual(bent.strains);
  });
});

describe("an exported page", () => {
  it("mixes the frames around what the cables are told", () => {
    const axes = [[0, 1, 4], [2], [0, 10]];
    const initial = [{ tension: 0.5 }, { tension: 2 }, { tension: 3 }];
    const linear = (frame: number): number => {
      // The frame of the file, after the others.
      if (frame === 6) return 4.5;
      const [i, k] = [Math.floor(frame / 2), frame % 2];
      return 3 * axes[0]![i]! + axes[2]![k]!;
    };
    for (const [a, c] of [[0, 0], [4, 10], [0.25, 3], [2.5, 10], [1, 5]] as const) {
      const mixed = around(axes, [{ tension: a }, { tension: 2 }, { tension: c }], initial, () => true)!;
      expect(mixed.reduce((sum, [, weight]) => sum + weight, 0)).toBeCloseTo(1, 14);
      expect(mixed.reduce((sum, [frame, weight]) => sum + weight * linear(frame), 0)).toBeCloseTo(3 * a + c, 12);
    }
    // Whatever is interpolated, the file's own frame is what it is; and where a node has no solution there is none.
    const own = around(axes, initial, initial, () => true)!;
    expect(own.reduce((sum, [frame, weight]) => sum + (frame === 6 ? 1 : frame ** 3) * weight, 0)).toBeCloseTo(1, 12);
    expect(around(axes, initial, initial, (frame) => frame !== 0)).toBeUndefined();
  });

  it("has the contacts of each frame", () => {
    const rubs = [1, 0.5, 1, 2, 3, 0, 0, 1, 4, 0.5, 0, 0, 1];
    const slides = [0, 0.25, 1, 2, 3, 0, 0, 1, -1, 0, 0, 0, -1];
    const numbers = new Float32Array([...rubs, ...slides]);
    const found = contacts(new Uint8Array([0, 2, 0]), numbers);
    expect(found.map((frame) => frame.length)).toEqual([0, 2, 0]);
    expect(found[1]![0]).toEqual({ obstacle: 1, arc_length: 0.5, point: [1, 2, 3], normal: [0, 0, 1], force: 4, friction: [0.5, 0, 0], sticks: true });
    expect(found[1]![1]).toMatchObject({ force: null, friction: null, sticks: false });
  });

  it("interpolates movable objects", () => {
    const half = Math.SQRT1_2;
    // Two objects in two frames: one moves and turns a quarter about z, the other stays, with either quaternion of its orientation.
    const poses = new Float32Array([0, 0, 0, 1, 0, 0, 0, 5, 5, 5, 0, 1, 0, 0, 2, 4, 6, half, 0, 0, half, 5, 5, 5, 0, -1, 0, 0]);
    const [moved, stays] = objects([1, 4], poses, [[0, 0.5], [1, 0.5]]);
    expect(moved!.obstacle).toBe(1);
    expect(moved!.pose.position).toEqual([1, 2, 3]);
    expect(moved!.pose.orientation[0]).toBeCloseTo(Math.cos(Math.PI / 8), 6);
    expect(moved!.pose.orientation[3]).toBeCloseTo(Math.sin(Math.PI / 8), 6);
    expect(stays).toEqual({ obstacle: 4, pose: { position: [5, 5, 5], orientation: [0, 1, 0, 0] } });
    // At a frame itself it is where that has it.
    expect(objects([1, 4], poses, [[1, 1]])[0]!.pose.position).toEqual([2, 4, 6]);
  });

  it("adds strains up to a circle", () => {
    let pose: Pose = { position: [0, 0, 0], orientation: [1, 0, 0, 0] };
    for (let i = 0; i < 10; i++) pose = move(pose, [0, 0, 0.02], [0, 0.1 * Math.PI, 0]);
    // Half a turn about y in a length of 0.2 ends a diameter away along x.
    expect(pose.position[0]).toBeCloseTo((2 * 0.2) / Math.PI, 14);
    expect(pose.position[2]).toBeCloseTo(0, 14);
    // Strains so small that the series counts.
    const little = move({ position: [0, 0, 0], orientation: [1, 0, 0, 0] }, [0, 0, 1], [0, 9e-3, 0]);
    expect(little.position[0]).toBeCloseTo((1 - Math.cos(9e-3)) / 9e-3, 11);
  });
});

describe("moments of strains", () => {
  it("are those of the bending and twist beyond those at rest, and of what couples them to shear and stretch", () => {
    // For shear, stretch, bending and twist; strains of the page begin with bending.
    const rows: [number, number, number, number, number, number][] = [[0, 0, 0, 2, 0, 0], [0, 0, 5, 0, 3, 0], [0.5, 0, 0, 0, 0, 4]];
    const [x, y, z] = momentsOf(rows, [0.1, 0, 0.2], [1.1, 2, 0.7, 0.4, 0.3, 0.01]);
    expect(x).toBeCloseTo(2, 12);
    expect(y).toBeCloseTo(6.05, 12);
    expect(z).toBeCloseTo(2.2, 12);
  });
});

describe("the sharpness of the view", () => {
  /** The last of so many pictures, each of which takes this long. */
  const moved = (sharpness: Sharpness, pictures: number, time: number): number => {
    for (let k = 0; k < pictures; k++) {
      void sharpness.moving;
      sharpness.took(time);
    }
    return sharpness.moving;
  };

  it("is that of the display where pictures are drawn in time", () => {
    const sharpness = new Sharpness(1.5, true);
    expect(moved(sharpness, 100, 8)).toBe(1.5);
    const card = new Sharpness(1.5, false);
    expect(moved(card, 100, 50)).toBe(1.5);
    expect([card.still, sharpness.still]).toEqual([1.5, 2]);
  });

  it("falls while pictures take long, not below what can be seen, and comes back where they are fast", () => {
    const sharpness = new Sharpness(1, true);
    expect(moved(sharpness, 3, 50)).toBeCloseTo(0.8, 12);
    expect(moved(sharpness, 201, 50)).toBeCloseTo(0.4, 12);
    expect(moved(sharpness, 3, 4)).toBeCloseTo(0.5, 12);
    // What rests is drawn finely, which takes its time and says nothing of what moves.
    void sharpness.still;
    sharpness.took(500);
    sharpness.took(500);
    sharpness.took(500);
    expect(sharpness.moving).toBeCloseTo(0.5, 12);
  });
});

describe("the spring that drags", () => {
  it("comes to rest where its force is that of its length, however soft the robot is", () => {
    for (const compliance of [1e-3, 0.05, 0.5, 5]) {
      const spring = new Spring(3, [0, 0, 0.1], [0, 0, 0], 2, 0.2);
      spring.move([0.05, 0, 0.1]);
      let at: Vector = [0, 0, 0.1];
      let force: Vector | undefined = [0, 0, 0];
      for (let k = 0; k < 60 && force; k++) {
        force = spring.next(at);
        at = [compliance * spring.force[0], 0, 0.1];
      }
      expect(force).toBeUndefined();
      // 2 N for half of 0.2 m: 20 N/m.
      expect(spring.force[0]).toBeCloseTo((20 * 0.05) / (1 + 20 * compliance), 2);
    }
  });

  it("gives up where the shape jumps to and fro, until the pointer moves", () => {
    const spring = new Spring(3, [0, 0, 0.1], [0, 0, 0], 2, 0.2);
    spring.move([0.1, 0, 0.1]);
    let count = 0;
    // It buckles to either side, whatever the force.
    for (let side = 1; count < 1000 && spring.next([0.1 * side, 0, 0.05]); side = -side) count++;
    expect(count).toBeGreaterThan(20);
    expect(count).toBeLessThan(200);
    expect(spring.isRestless).toBe(true);
    spring.move([0.05, 0, 0.1]);
    expect(spring.isRestless).toBe(false);
    expect(spring.next([0, 0, 0.1])).toBeDefined();
  });

  it("goes back to the last force that had a shape", () => {
    const spring = new Spring(3, [0, 0, 0.1], [0.5, 0, 0], 2, 0.2);
    spring.move([0.05, 0, 0.1]);
    const first = spring.next([0, 0, 0.1])!;
    expect(first[0]).toBeGreaterThan(0.5);
    expect(spring.back()).toEqual([0.5, 0, 0]);
    expect(spring.isStopped).toBe(true);
  });
});

describe("what acts on the robot", () => {
  const state = { ...initialState(scene), tipForce: [0.3, 0, 0] as Vector, tipMoment: [0, 0, 0] as Vector, gravity: [0, 0, 0] as Vector };
  const straight: Solved = { ...solved, positions: [[0, 0, 0], [0, 0, 0.1], [0, 0, 0.2]], orientations: [1, 2, 3].map(() => [1, 0, 0, 0]), contacts: [] };
  const bare: Scene = { ...scene, loads: [], base: { position: [0, 0, 0], orientation: [1, 0, 0, 0] }, tip_follower: false };

  it("is drawn as in the static pictures: the longest arrow for the largest force, with its value", () => {
    const pulled = { ...state, pull: { arc_length: 0.1, force: [0, 0.15, 0] as Vector } };
    const { arrows, labels } = acting(bare, loadsOf(bare, pulled), straight, [], "#000000");
    expect(arrows.map(({ tail, head }) => Math.hypot(head[0] - tail[0], head[1] - tail[1], head[2] - tail[2]))).toEqual([
      expect.closeTo(0.04, 12), expect.closeTo(0.02, 12),
    ]);
    expect(labels.map(({ text }) => text)).toEqual(["force 0.3 N", "force 0.15 N"]);
  });

  it("presses against the tip where it pushes", () => {
    const { arrows } = acting(bare, loadsOf(bare, { ...state, tipForce: [0, 0, -1] }), straight, [], "#000000");
    expect(arrows[0]!.head).toEqual([0, 0, 0.2]);
    expect(arrows[0]!.tail[2]).toBeCloseTo(0.24, 12);
  });

  it("has combs, masses and contacts", () => {
    const loads: Scene["loads"] = [
      { kind: "spread", arc_lengths: [0, 0.2], forces: [[0, 2, 0], [0, 0, 0]], moments: [[0, 0, 0], [0, 0, 0]], follows: false },
      { kind: "mass", arc_length: 0.05, mass: 0.02 },
    ];
    const touch = { ...solved.contacts[0]!, point: [0.1, 0, 0] as Vector, normal: [1, 0, 0] as Vector, force: 0.04, friction: null };
    const { arrows, backs, labels, masses } = acting(bare, { ...loadsOf(bare, { ...state, tipForce: [0, 0, 0] }), loads }, straight, [{ ...straight, contacts: [touch] }], "#000000");
    expect(backs).toHaveLength(1);
    expect(masses).toEqual([[0, 0, 0.05]]);
    expect(labels.map(({ text }) => text)).toEqual(["load 2 N/m", "40 mN", "mass 20 g"]);
    // A contact pushes from within the obstacle.
    expect(arrows.at(-1)!.head).toEqual([0.1, 0, 0]);
    expect(arrows.at(-1)!.tail[0]).toBeLessThan(0.1);
  });
});

describe("a comparison", () => {
  it("has the root of the mean square over the disks", () => {
    const far = solved.positions.map(([x, y, z], i): Vector => [x + (i === 0 ? 0 : 0.003), y, z]);
    const disks = [0, 1].map((station) => ({ ...scene.disks[0]!, station }));
    expect(rootMeanSquare({ ...scene, disks }, solved.positions, far)).toBeCloseTo(0.003 / Math.SQRT2, 12);
  });
});

describe("a picture", () => {
  it("has its size and resolution", () => {
    const options = { format: "png", width: 25.4, height: 50.8, resolution: 300, transparent: false, labels: true, bar: true, grid: false } as const;
    expect(pixels(options)).toEqual([300, 600]);
    expect(() => pixels({ ...options, width: 2000, resolution: 2400 })).toThrow("8192");
    // Signature, a first chunk, and what follows.
    const png = Uint8Array.from({ length: 60 }, (_, i) => i);
    const made = withResolution(png, 300);
    expect(made.length).toBe(81);
    expect(String.fromCharCode(...made.subarray(37, 41))).toBe("pHYs");
    expect(new DataView(made.buffer).getUint32(41)).toBe(11811);
    expect([...made.subarray(54)]).toEqual([...png.subarray(33)]);
  });

  it("has a bar of a round length", () => {
    expect(scaleBar(1000, 120)).toEqual({ pixels: 100, words: "100 mm" });
    expect(scaleBar(50, 120)).toEqual({ pixels: 100, words: "2 m" });
    expect(scaleBar(7e5, 120).words).toBe("0.1 mm");
  });
});

describe("the interpolation of an exported page", () => {
  it("is that of the server, which tries it against solves", () => {
    for (const { axes, commands, initial, unsolved, weights } of interpolation.mixes) {
      const found = around(axes, commands as Command[], initial as Command[], (frame) => !unsolved.includes(frame));
      const sum = (all: number[][] | undefined): Map<number, number> => {
        const sums = new Map<number, number>();
        for (const [frame, weight] of all ?? []) sums.set(frame!, (sums.get(frame!) ?? 0) + weight!);
        return sums;
      };
      expect(found === undefined).toBe(weights === null);
      const [own, expected] = [sum(found), sum(weights ?? undefined)];
      expect([...own.keys()].sort()).toEqual([...expected.keys()].sort());
      for (const [frame, weight] of own) expect(weight).toBeCloseTo(expected.get(frame)!, 12);
    }
  });

  it("adds strains up as the server does", () => {
    for (const { base, strains, lengths, poses } of interpolation.paths) {
      let pose = base as Pose;
      strains.forEach((strain, piece) => {
        const [linear, angular] = strain.map((part) => part.map((x) => x * lengths[piece]!)) as [Vector, Vector];
        pose = move(pose, linear, angular);
        const expected = poses[piece + 1]!;
        pose.position.forEach((x, k) => expect(x).toBeCloseTo(expected.position[k]!, 12));
        pose.orientation.forEach((x, k) => expect(x).toBeCloseTo(expected.orientation[k]!, 12));
      });
    }
  });
});
