// The layout of masses and links in a drawing: levels from the road upwards, a lane for each chain of links.

const GROUND = 'ground';
const MOST_LANES = 7;

function axleLayout(axle, axis) {
  const points = axle.points.filter((own) => own.axis === axis);
  const own = axle.links.filter((link) => link.axis === axis);
  const carriers = carriersOf(points, own);
  const links = own.map((link) => ({ link, ends: grounded(link.ends.filter((end) => !carriers.has(end.point))) }));
  if (links.some(({ ends }) => ends.some((end) => end.point === GROUND)))
    points.push({ name: GROUND, axis, kind: 'road', inertia: null });
  const place = new Map(points.map((own) => [own.name, { own, level: 0, lanes: [], turns: [] }]));
  carriers.forEach((mass, angle) => place.get(mass).turns.push(place.get(angle).own));
  assignLevels(place, links);
  for (let tries = 0; tries < points.length; tries += 1) {
    assignLanes(place, links);
    const hidden = overlaps(place)[0];
    if (!hidden) break;
    raise(place, hidden);
  }
  return { place, links };
}

// The mass that turns by an angle: the only one that all links of the angle have in common, as in `body + a*pitch`. A link to a point of that mass
// is drawn to the mass; any other angle is drawn as a part of its own.
function carriersOf(points, links) {
  const isMass = (name) => points.some((own) => own.name === name && own.kind === 'mass' && !own.angle);
  const found = new Map();
  for (const { name } of points.filter((own) => own.angle)) {
    const others = links
      .map(({ ends }) => ends.map((end) => end.point))
      .filter((names) => names.includes(name))
      .map((names) => names.filter((other) => other !== name));
    if (!others.length || others.some((names) => names.length < 2)) continue;
    const common = others[0].filter((other) => isMass(other) && others.every((names) => names.includes(other)));
    if (common.length === 1) found.set(name, common[0]);
  }
  return found;
}

// A link with one end connects that end to the ground.
function grounded(ends) {
  return ends.length > 1 ? ends : [...ends, { point: GROUND, share: -1 }];
}

// Places upper ends above lower ones, as far as the links are consistent.
function assignLevels(place, links) {
  const above = new Map([...place.keys()].map((name) => [name, new Set()]));
  const reaches = (from, to) => from === to || [...above.get(from)].some((next) => reaches(next, to));
  const isFloor = (name) => ['road', 'motion'].includes(place.get(name).own.kind);
  for (const { ends } of links) {
    for (const end of ends.slice(1)) {
      const [low, high] = isFloor(ends[0].point) ? [ends[0].point, end.point] : [end.point, ends[0].point];
      if (end.share > 0 && ends.length > 2) continue;
      if (!reaches(high, low)) above.get(low).add(high);
      else if (!reaches(low, high)) above.get(high).add(low);
    }
  }
  const below = (name) => [...above.keys()].filter((low) => above.get(low).has(name));
  const depth = (name) => (isFloor(name) ? 0 : Math.max(1, ...below(name).map((low) => depth(low) + 1)));
  place.forEach((own, name) => {
    own.level = depth(name);
  });
  place.forEach((own, name) => {
    if (isFloor(name) || below(name).length || !above.get(name).size) return;
    own.level = Math.max(1, Math.min(...[...above.get(name)].map((high) => place.get(high).level)) - 1);
  });
}

function extent(place, ends) {
  const levels = ends.map((end) => place.get(end.point).level);
  return [Math.min(...levels), Math.max(...levels)];
}

function assignLanes(place, links) {
  const lanes = [];
  const sorted = [...links].sort(
    (a, b) =>
      extent(place, a.ends)[0] - extent(place, b.ends)[0] || extent(place, b.ends)[1] - extent(place, a.ends)[1],
  );
  for (const own of sorted) {
    const [low, high] = extent(place, own.ends);
    const joins = (lane) =>
      lane.every(([from, to]) => high <= from || low >= to) &&
      lane.some(([, , names]) => own.ends.some((end) => names.includes(end.point)));
    let lane = lanes.findIndex(joins);
    if (lane < 0) lane = lanes.push([]) - 1;
    lanes[lane].push([low, high, own.ends.map((end) => end.point)]);
    own.lane = lane;
  }
  best(place, links, lanes.length);
}

// The order of the lanes with the fewest overlaps.
function best(place, links, count) {
  const first = links.map((own) => own.lane);
  const orders = count <= MOST_LANES ? permutations([...Array(count).keys()]) : [[...Array(count).keys()]];
  const apply = (order) => {
    links.forEach((own, at) => {
      own.lane = order[first[at]];
    });
    occupy(place, links);
  };
  let [least, chosen] = [Infinity, orders[0]];
  for (const order of orders) {
    apply(order);
    const spans = [...place.values()].reduce(
      (sum, { lanes }) => sum + (lanes.length ? Math.max(...lanes) - Math.min(...lanes) : 0),
      0,
    );
    const cost = 100 * overlaps(place).length + 30 * crossings(place, links) + spans;
    if (cost < least) [least, chosen] = [cost, order];
  }
  apply(chosen);
}

function permutations(items) {
  if (items.length < 2) return [items];
  return items.flatMap((item) => permutations(items.filter((other) => other !== item)).map((rest) => [item, ...rest]));
}

// A point extends across the lanes of the links that end at it; an arm connects it to a lever that only turns about it.
function occupy(place, links) {
  place.forEach((own) => {
    own.lanes = [];
  });
  for (const { ends, lane } of links) {
    const levels = extent(place, ends);
    ends
      .filter((end) => levels.includes(place.get(end.point).level))
      .forEach((end) => place.get(end.point).lanes.push(lane));
  }
}

function spans(own) {
  return [Math.min(...own.lanes), Math.max(...own.lanes)];
}

// Points that would be drawn over others.
function overlaps(place) {
  const all = [...place.values()].filter((own) => own.lanes.length);
  return all.filter((own, at) =>
    all.slice(0, at).some((other) => {
      const [[a, b], [c, d]] = [spans(own), spans(other)];
      return other.level === own.level && a <= d && c <= b;
    }),
  );
}

function crossings(place, links) {
  const all = [...place.values()].filter((own) => own.lanes.length);
  const crosses = ({ ends, lane }, own) => {
    const [low, high] = extent(place, ends);
    const [left, right] = spans(own);
    return own.level > low && own.level < high && lane >= left && lane <= right;
  };
  return links.reduce((sum, link) => sum + all.filter((own) => crosses(link, own)).length, 0);
}

// Moves a point to a separate level above the one that it shares.
function raise(place, hidden) {
  const level = hidden.level;
  place.forEach((own) => {
    if (own === hidden || own.level > level) own.level += 1;
  });
}
