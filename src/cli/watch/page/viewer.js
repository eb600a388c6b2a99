// Shows a .glb file by three.js, as it is shipped. Draws when something changes, never otherwise.
import * as THREE from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { RoomEnvironment } from 'three/addons/environments/RoomEnvironment.js';
import { MeshoptDecoder } from 'three/addons/libs/meshopt_decoder.module.js';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';

export class Viewer {
  // Switches, with what stands beside them.
  options = { wireframe: 'wireframe', normals: 'normals', joints: 'joints' };

  // `picked` is told of clicks on triangles: the asset's key, the index of the mesh, those of the corners.
  constructor(place, picked) {
    this.place = place;
    this.picked = picked;
    this.on = {};
    this.renderer = new THREE.WebGLRenderer({ antialias: true });
    this.renderer.toneMapping = THREE.NeutralToneMapping;
    this.renderer.setPixelRatio(devicePixelRatio);
    place.append(this.renderer.domElement);
    this.scene = new THREE.Scene();
    this.scene.background = new THREE.Color(0xe6e8ec);
    const light = new THREE.DirectionalLight(0xffffff, 2);
    light.position.set(1, 2, 3);
    this.scene.add(light, this.surroundings());
    this.camera = new THREE.PerspectiveCamera(30, 1, 0.01, 100);
    this.controls = new OrbitControls(this.camera, this.renderer.domElement);
    this.controls.addEventListener('change', () => this.draw());
    this.loader = new GLTFLoader().setMeshoptDecoder(MeshoptDecoder);
    this.model = null;
    this.turn = 0;
    this.normals = new THREE.MeshNormalMaterial({ side: THREE.DoubleSide });
    this.colored = new THREE.MeshLambertMaterial({ side: THREE.DoubleSide, vertexColors: true });
    this.listen();
    new ResizeObserver(() => this.resize()).observe(place);
    this.resize();
  }

  // Light from all sides: a room that metals reflect, or where a processor does the work of a graphics card, which would
  // need seconds for that, a sky.
  surroundings() {
    const context = this.renderer.getContext();
    const named = context.getExtension('WEBGL_debug_renderer_info')?.UNMASKED_RENDERER_WEBGL ?? context.RENDERER;
    if (/swiftshader|llvmpipe|software|basic render/i.test(context.getParameter(named))) {
      return new THREE.HemisphereLight(0xffffff, 0x8d8578, 2.5);
    }
    const rooms = new THREE.PMREMGenerator(this.renderer);
    this.scene.environment = rooms.fromScene(new RoomEnvironment(), 0.04).texture;
    this.scene.environmentIntensity = 0.6;
    rooms.dispose();
    return new THREE.Group();
  }

  // Loads an asset (`key` names its bytes, `address` is where they are); false where a later one came between, or its bytes are gone already.
  async load(asset) {
    const turn = ++this.turn;
    const answer = await fetch(asset.address);
    if (answer.status !== 200) return false;
    const bytes = await answer.arrayBuffer();
    performance.mark('kiln-bytes', { detail: asset.key });
    const file = await this.loader.parseAsync(bytes, '');
    if (turn !== this.turn) {
      dispose(file.scene);
      return false;
    }
    const first = !this.model;
    this.remove();
    const joints = new THREE.SkeletonHelper(file.scene);
    this.model = { key: asset.key, file, scene: file.scene, joints, mixer: new THREE.AnimationMixer(file.scene), lod: 0 };
    file.scene.traverse((object) => {
      if (!object.material) return;
      object.userData.kilnMaterial = object.material;
      object.userData.kilnGeometry = object.geometry;
      object.userData.kilnLevels = [object.geometry];
    });
    this.model.fans = new Fans(file.scene, asset.joints ?? []);
    this.scene.add(file.scene, joints, this.model.fans.group);
    this.unpick();
    if (first) this.fit();
    this.clip();
    this.wear();
    performance.mark('kiln-loaded', { detail: asset.key });
    return true;
  }

  // Takes the model away; the next one is fitted into the picture.
  forget() {
    this.turn += 1;
    this.remove();
    this.unpick();
    this.draw();
  }

  remove() {
    if (!this.model) return;
    this.scene.remove(this.model.scene, this.model.joints, this.model.fans.group);
    dispose(this.model.scene);
    dispose(this.model.fans.group);
    this.model.joints.dispose();
    this.model = null;
  }

  set(name, value) {
    this.on[name] = value;
    this.wear();
  }

  // Puts on what the switches say.
  wear() {
    if (!this.model) return;
    this.model.joints.visible = Boolean(this.on.joints);
    this.model.fans.group.visible = Boolean(this.on.joints);
    this.normals.wireframe = Boolean(this.on.wireframe);
    this.colored.wireframe = Boolean(this.on.wireframe);
    this.model.scene.traverse((object) => {
      const own = object.userData.kilnMaterial;
      if (!own) return;
      const { kilnHeat: heat, kilnGeometry: geometry } = object.userData;
      object.geometry = heat ?? geometry;
      object.material = this.on.normals && object.isMesh ? this.normals : heat ? this.colored : own;
      for (const material of [own].flat()) material.wireframe = Boolean(this.on.wireframe);
    });
    this.draw();
  }

  // Shows a level of detail: nodes that stand for others at it (`MSFT_lod`) lend them their triangles, and of nodes that are
  // levels by their names the others are hidden.
  async level(number) {
    const { model } = this;
    if (!model || number === model.lod) return;
    const { parser } = model.file;
    const work = [];
    model.scene.traverse((object) => {
      if (!object.isMesh) return;
      const { nodes, primitives: part = 0 } = { ...parser.associations.get(object.parent), ...parser.associations.get(object) };
      const ids = parser.json.nodes[nodes]?.extensions?.MSFT_lod?.ids;
      if (ids) work.push(this.lend(object, part, number === 0 ? null : ids[Math.min(number, ids.length) - 1]));
    });
    await Promise.all(work);
    if (model !== this.model) return;
    for (const levels of named(model.scene)) {
      levels.forEach((object, own) => { object.visible = own === Math.min(number, levels.length - 1); });
    }
    model.lod = number;
    this.unpick();
    this.wear();
  }

  // Gives a part of a mesh the triangles that it has at another node; what is not there is not drawn.
  async lend(object, part, node) {
    const { associations } = this.model.file.parser;
    let lender = object;
    if (node !== null) {
      const other = await this.model.file.parser.getDependency('node', node);
      lender = null;
      other.traverse((one) => { if (one.isMesh && (associations.get(one)?.primitives ?? 0) === part) lender = one; });
    }
    const [finest, ...others] = object.userData.kilnLevels;
    const geometry = lender === object ? finest : lender?.geometry ?? new THREE.BufferGeometry();
    if (geometry !== finest && !others.includes(geometry)) object.userData.kilnLevels.push(geometry);
    object.userData.kilnHeat?.dispose();
    delete object.userData.kilnHeat;
    object.userData.kilnGeometry = geometry;
    object.userData.kilnMesh = associations.get(lender)?.meshes;
  }

  // The names of joints that carry a skin.
  joints() {
    const names = new Set();
    this.model?.scene.traverse((object) => {
      for (const bone of object.skeleton?.bones ?? []) names.add(bone.userData.name ?? bone.name);
    });
    return [...names];
  }

  // Shows what is measured as colors, or with null the materials again; gives the scale, or why there is none.
  async heat(what) {
    const { model } = this;
    if (!model) return '';
    const answer = what ? await fetch(`/heat?key=${model.key}&lod=${model.lod}&heat=${encodeURIComponent(what)}`) : null;
    const says = answer?.headers.get('content-type')?.startsWith('text/plain');
    const bytes = answer?.status === 200 && !says ? await answer.arrayBuffer() : null;
    const complaint = says ? (await answer.text()).trim() : '';
    if (model !== this.model) return '';
    const found = bytes ? readColors(bytes) : null;
    model.scene.traverse((object) => {
      if (!object.isMesh) return;
      object.userData.kilnHeat?.dispose();
      delete object.userData.kilnHeat;
      const { associations } = model.file.parser;
      const part = associations.get(object)?.primitives ?? 0;
      const node = associations.get(object)?.nodes ?? associations.get(object.parent)?.nodes;
      const colors = found?.colors.get(`${node}/${part}`);
      if (!colors) return;
      const plain = object.userData.kilnGeometry;
      const heat = plain.index ? plain.toNonIndexed() : plain.clone();
      heat.setAttribute('color', new THREE.BufferAttribute(colors, 3));
      object.userData.kilnHeat = heat;
    });
    this.unpick();
    this.wear();
    return found?.scale ?? complaint;
  }

  // Shows a moment of a clip, -1 for rest.
  pose(clip, time) {
    const { model } = this;
    if (!model) return;
    const chosen = model.file.animations[clip];
    if (model.clip !== chosen) {
      model.mixer.stopAllAction();
      model.clip = chosen;
      if (chosen) {
        const action = model.mixer.clipAction(chosen).setLoop(THREE.LoopOnce);
        action.clampWhenFinished = true;
        action.play();
      }
    }
    if (chosen) model.mixer.setTime(time);
    this.unpick();
    this.draw();
  }

  // The whole model in the picture, from where the camera looks.
  fit() {
    if (!this.model) return;
    const box = new THREE.Box3().setFromObject(this.model.scene);
    const radius = Math.max(box.getSize(new THREE.Vector3()).length() / 2, 1e-6);
    const way = this.camera.position.clone().sub(this.controls.target);
    if (way.lengthSq() === 0) way.set(0.57, 0.38, 0.76);
    const half = THREE.MathUtils.degToRad(this.camera.fov / 2);
    const narrow = Math.min(1, this.camera.aspect);
    box.getCenter(this.controls.target);
    this.camera.position.copy(this.controls.target).addScaledVector(way.normalize(), radius / Math.sin(half) / narrow);
    this.controls.update();
    this.draw();
  }

  // Near and far planes around what there is, wherever the camera stands.
  clip() {
    const box = new THREE.Box3().setFromObject(this.model.scene);
    this.reach = box.isEmpty() ? null : box.getBoundingSphere(new THREE.Sphere());
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.place;
    if (width === 0 || height === 0) return;
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.draw();
  }

  draw() {
    if (this.drawing) return;
    this.drawing = requestAnimationFrame(() => {
      this.drawing = null;
      if (this.reach) {
        const away = this.camera.position.distanceTo(this.reach.center);
        this.camera.near = Math.max(away - 2 * this.reach.radius, this.reach.radius / 1000, 1e-6);
        this.camera.far = away + 4 * this.reach.radius;
        this.camera.updateProjectionMatrix();
      }
      if (this.on.joints) this.model?.fans.turn();
      this.renderer.render(this.scene, this.camera);
      if (this.model) performance.mark('kiln-drawn', { detail: this.model.key });
    });
  }

  listen() {
    let start = null;
    const { domElement } = this.renderer;
    domElement.addEventListener('pointerdown', (event) => { start = [event.clientX, event.clientY]; });
    domElement.addEventListener('pointerup', (event) => {
      const still = start && Math.hypot(event.clientX - start[0], event.clientY - start[1]) < 3;
      if (still && event.button === 0) this.pick(event);
    });
  }

  pick(event) {
    if (!this.model) return;
    const { left, top, width, height } = this.renderer.domElement.getBoundingClientRect();
    const place = new THREE.Vector2(((event.clientX - left) / width) * 2 - 1, 1 - ((event.clientY - top) / height) * 2);
    const ray = new THREE.Raycaster();
    ray.setFromCamera(place, this.camera);
    const hit = ray.intersectObject(this.model.scene).find((one) => one.face);
    this.unpick();
    this.draw();
    if (!hit) return;
    const drawn = [hit.face.a, hit.face.b, hit.face.c];
    // Colors stand on corners of their own; the file knows those that triangles share.
    const { index } = hit.object.userData.kilnGeometry;
    const corners = hit.object.userData.kilnHeat && index ? drawn.map((corner) => index.getX(corner)) : drawn;
    const points = drawn.map((corner) => {
      const point = hit.object.getVertexPosition(corner, new THREE.Vector3());
      return hit.object.localToWorld(point);
    });
    const lines = new THREE.BufferGeometry().setFromPoints(points);
    const look = new THREE.LineBasicMaterial({ color: 0xff3d00, depthTest: false });
    this.mark = new THREE.LineLoop(lines, look);
    this.scene.add(this.mark);
    const mesh = hit.object.userData.kilnMesh ?? this.model.file.parser.associations.get(hit.object)?.meshes;
    if (mesh !== undefined) this.picked(this.model.key, mesh, corners);
  }

  unpick() {
    if (!this.mark) return;
    this.scene.remove(this.mark);
    dispose(this.mark);
    this.mark = null;
  }
}

// How far joints may turn, drawn at each: a fan for each axis with a range, where the turns before leave it (about x, then z,
// then y, which is the bone), and a needle at the angle of the moment, red where that is outside.
class Fans {
  constructor(scene, joints) {
    const nodes = new Map();
    scene.traverse((object) => nodes.set(object.userData.name ?? object.name, object));
    this.group = new THREE.Group();
    this.joints = joints.filter(({ name }) => nodes.has(name)).map((joint) => this.joint(nodes.get(joint.name), joint));
  }

  joint(node, { rest, ranges, length }) {
    const frame = new THREE.Group();
    frame.matrixAutoUpdate = false;
    this.group.add(frame);
    const fans = ranges.map((range, axis) => (range && range[1] > range[0] ? this.fan(frame, axis, range, 0.4 * length) : null));
    return { node, frame, ranges, fans, rest: new THREE.Quaternion(...rest) };
  }

  fan(frame, axis, [least, most], radius) {
    const end = (degrees) => FROM[axis].clone().multiplyScalar(radius).applyAxisAngle(AXES[axis], THREE.MathUtils.degToRad(degrees));
    const steps = Math.max(2, Math.ceil((most - least) / 5));
    const rim = Array.from({ length: steps + 1 }, (_, step) => end(least + ((most - least) * step) / steps));
    const zero = new THREE.Vector3();
    const sides = rim.slice(1).flatMap((point, step) => [zero, rim[step], point]);
    const look = { color: COLORS[axis], side: THREE.DoubleSide, transparent: true, opacity: 0.4, depthTest: false };
    const blade = new THREE.Mesh(new THREE.BufferGeometry().setFromPoints(sides), new THREE.MeshBasicMaterial(look));
    const line = new THREE.BufferGeometry().setFromPoints([zero, end(0)]);
    const needle = new THREE.Line(line, new THREE.LineBasicMaterial({ depthTest: false }));
    const turned = new THREE.Group();
    turned.add(blade, needle);
    frame.add(turned);
    return { turned, needle };
  }

  // Puts all of them where the joints are now.
  turn() {
    const place = new THREE.Matrix4();
    for (const { node, frame, ranges, fans, rest } of this.joints) {
      node.parent.updateWorldMatrix(true, false);
      place.makeRotationFromQuaternion(rest).setPosition(node.position);
      frame.matrix.multiplyMatrices(node.parent.matrixWorld, place);
      frame.matrixWorldNeedsUpdate = true;
      const angles = nearest(rest.clone().invert().multiply(node.quaternion), ranges);
      const [x, , z] = [0, 1, 2].map((axis) => new THREE.Quaternion().setFromAxisAngle(AXES[axis], angles[axis] * DEGREE));
      const before = [new THREE.Quaternion(), x.clone().multiply(z), x];
      fans.forEach((fan, axis) => {
        if (!fan) return;
        fan.turned.quaternion.copy(before[axis]);
        fan.needle.quaternion.setFromAxisAngle(AXES[axis], angles[axis] * DEGREE);
        fan.needle.material.color.set(excess(ranges[axis], angles[axis]) > 1e-3 ? 0xd50000 : 0x202428);
      });
    }
  }
}

const DEGREE = Math.PI / 180;
const AXES = [new THREE.Vector3(1, 0, 0), new THREE.Vector3(0, 1, 0), new THREE.Vector3(0, 0, 1)];
// Where fans count from: the bone, and about the bone its z.
const FROM = [AXES[1], AXES[2], AXES[1]];
const COLORS = [0xe53935, 0x43a047, 0x1e88e5];

const excess = (range, angle) => (range ? Math.max(range[0] - angle, angle - range[1], 0) : 0);

// The angles of a rotation about x, then z, then y, degrees: of its two triples, whole turns added, that with the least excess.
function nearest(rotation, ranges) {
  const m = new THREE.Matrix4().makeRotationFromQuaternion(rotation).elements;
  const z = Math.atan2(-m[4], Math.hypot(m[0], m[8]));
  const flat = Math.hypot(m[0], m[8]) > 1e-7;
  const x = flat ? Math.atan2(m[6], m[5]) : Math.atan2(-m[9], z > 0 ? m[1] : -m[1]);
  const first = [x / DEGREE, (flat ? Math.atan2(m[8], m[0]) : 0) / DEGREE, z / DEGREE];
  const turned = ([a, b, c]) => [a, b, c].map((angle, axis) => {
    const middle = ranges[axis] ? (ranges[axis][0] + ranges[axis][1]) / 2 : 0;
    return angle - 360 * Math.round((angle - middle) / 360);
  });
  const sum = (angles) => angles.reduce((all, angle, axis) => all + excess(ranges[axis], angle), 0);
  const [one, other] = [turned(first), turned([first[0] + 180, first[1] + 180, 180 - first[2]])];
  return sum(other) < sum(one) ? other : one;
}

// Objects that are levels of detail by their names, the finest first.
function named(scene) {
  const all = new Map();
  scene.traverse((object) => {
    const name = object.userData.name ?? object.name;
    const [, own, number] = /^(.*?)(?:_LOD(\d+))?$/.exec(name);
    const mesh = object.isMesh || object.children.some((child) => child.isMesh && !child.userData.name);
    if (own && mesh) all.set(own, [...all.get(own) ?? [], [Number(number ?? 0), object]]);
  });
  const levels = [...all.values()].map((list) => list.sort(([a], [b]) => a - b));
  return levels.filter((list) => list.length > 1 && list.every(([number], place) => number === place))
    .map((list) => list.map(([, object]) => object));
}

// The colors of `/heat` by node and primitive, and their scale in words.
function readColors(bytes) {
  const end = new Uint8Array(bytes).indexOf(10) + 1;
  const head = JSON.parse(new TextDecoder().decode(bytes.slice(0, end)));
  const colors = new Map();
  let start = end;
  for (const { node, part, triangles } of head.pieces) {
    colors.set(`${node}/${part}`, new Float32Array(bytes, start, triangles * 9));
    start += triangles * 36;
  }
  const number = (value) => Number(value.toPrecision(3)).toString();
  const most = head.greatest > head.high ? `, up to ${number(head.greatest)}` : '';
  return { colors, scale: `${head.title}: violet ${number(head.low)} to yellow ${number(head.high)}${most}` };
}

// Frees what a model has on the graphics card.
function dispose(root) {
  root.traverse((object) => {
    object.geometry?.dispose();
    for (const geometry of object.userData.kilnLevels ?? []) geometry.dispose();
    object.userData.kilnHeat?.dispose();
    object.skeleton?.dispose();
    for (const material of [object.userData.kilnMaterial ?? object.material ?? []].flat()) {
      for (const value of Object.values(material)) if (value?.isTexture) value.dispose();
      material.dispose();
    }
  });
}
