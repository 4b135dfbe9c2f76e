// The answer in sentences.

// RMS residual in standard deviations above which noise does not explain it, as in the verdict of the command line.
const LARGE = 2;

// A rival whose log evidence is lower by less than this has at least a twentieth of the probability of the answer.
const APART = Math.log(20);

const LEFT_IN = {
  sweep: 'sweeps',
  cleat: 'cleat runs',
  record: 'time histories',
  kc_force: 'K&C curves',
  kc_hysteresis: 'the hysteresis of K&C curves',
  kc_sine: 'K&C sines',
};

// The residual of each sensor with the model of the answer, the largest first.
function leftOver({ left, by_channel: deviations, effects }) {
  const side = effects.length ? 'after' : 'before';
  const parts = left.map((own) => ({
    text: `${words(own.channel)} in ${LEFT_IN[own.kind]}`,
    percent: own[`${side}_percent`],
    deviations: deviations[own.channel] ? deviations[own.channel][side] : null,
  }));
  return parts.sort((a, b) => b.percent - a.percent);
}

function lead({ summary, discover }) {
  if (summary.verdict !== 'found') {
    return `${words(summary.missing.charAt(0).toUpperCase() + summary.missing.slice(1))}.`;
  }
  const names = together(discover.effects.map(placed));
  const alike = rivalsAlike(discover).map((rival) => `${words(rival.effect)} at ${words(rival.at)}`);
  const rivals = alike.length ? `, not distinguishable from ${alike.join(' or ')}` : '';
  return discover.partly_explained
    ? `Partly explained by ${names}${rivals}. Large residuals remain.`
    : `Missing: ${names}${rivals}.`;
}

// Rivals of the effects of the answer that are not distinguishable from them.
function rivalsAlike({ effects }) {
  return effects.filter((effect) => !effect.one_of).flatMap(({ rivals }) => rivals.filter((own) => own.behind < APART));
}

function consequence(discover, { verdict: kind }, likely) {
  const judged =
    discover.gap.held_out.before !== null ? ['held-out', discover.gap.held_out] : ['fitted', discover.gap.fit];
  const [which, gap] = judged;
  const before = `On ${which} runs the residual of the baseline model is ${number(gap.before)} standard deviations`;
  const after = `that of the extended model ${number(gap.after)}; noise alone gives 1`;
  const [best, ...others] = alternatives(discover.effects);
  const [chosen] = best || discover.effects;
  const instead = others.map((own) => own.map(placed).join(' and ')).join(', or ');
  const place = likely
    ? ` Something at ${words(likely.place)} could explain up to ${percent(likely.ceiling)} of the residuals of the sweeps.`
    : '';
  switch (kind) {
    case 'none':
      return `${before}; noise alone gives 1. ${unneeded(gap)} ${mostLeft(discover)}`;
    case 'found':
      return `${before}, ${after}.${likelihood(discover)}${nextBest(chosen)} ${mostLeft(discover)}`;
    case 'class':
      return `${before}; with ${added(discover.effects)} it is ${number(gap.after)}; noise alone gives 1. With ${instead} instead the fitted runs are explained equally well, so no model file is written.${nextBest(chosen)} ${mostLeft(discover)}`;
    default:
      return `${before}; noise alone gives 1. No effect of the catalogue explains it. The map below shows where it occurs.${place}${learnedLaw(discover)} ${mostLeft(discover)}`;
  }
}

// The fitted runs may show no effect although other runs are predicted badly.
function unneeded(gap) {
  return gap.before > LARGE
    ? 'The fitted runs show no effect of the catalogue, but the model does not predict these runs.'
    : 'No effect of the catalogue is needed.';
}

function learnedLaw({ learned }) {
  if (!learned) return '';
  const laws = learned.laws.map(placed).join(' and ');
  const share = learned.explained === null ? '' : `, which would explain ${percent(learned.explained, 3)} of it`;
  return ` Learned from the data, without a physical cause: ${laws}${share}.`;
}

function likelihood({ probability }) {
  return probability === null
    ? ''
    : ` The probability of the answer among all sets that were tried is ${chance(probability)}.`;
}

function chance(probability) {
  if (probability > 0.999) return 'more than 99.9 %';
  return probability < 0.001 ? 'less than 0.1 %' : percent(probability, 3);
}

function nextBest(chosen) {
  const rival = chosen && chosen.rivals[0];
  if (!rival) return '';
  return ` The next best explanation, ${words(rival.effect)} at ${words(rival.at)}, is ${odds(rival.behind)}, compared before its fit had converged.`;
}

// The probability relative to the answer of a rival whose log evidence is lower by `behind`.
function odds(behind) {
  const power = Math.abs(behind) / Math.LN10;
  if (power < 0.05) return 'as probable';
  const times = power < 4 ? number(10 ** power, 2) : `10${superscript(Math.round(power))}`;
  return `${times} times ${behind > 0 ? 'less' : 'more'} probable`;
}

// The sensor with the largest residual relative to its signal.
function mostLeft(discover) {
  const [most] = leftOver(discover);
  if (!most) return '';
  const noise = most.deviations === null ? '' : `, ${number(most.deviations)} standard deviations`;
  return `Largest residual: ${most.text}, ${number(most.percent, 2)} % of the signal${noise}.`;
}

// The fit percentage of the rig runs may fall although the model improves.
function fallingFit({ rig: ratios }) {
  const parts = ['fit', 'held_out'].flatMap((role) => {
    const own = ratios.filter((ratio) => ratio.role === role && ratio.quality_after);
    const of = (quality, part) => mean(own.map((ratio) => ratio[quality][`fit_${part}`]));
    return ['magnitude', 'phase']
      .map((part) => [part, of('quality_before', part), of('quality_after', part)])
      .filter(([, before, after]) => before !== null && number(after) !== number(before) && after < before)
      .map(([part, before, after]) => `${part} from ${number(before)} to ${number(after)} % (${roleName(role)} runs)`);
  });
  if (!parts.length) return null;
  return `The fit percentage falls: ${parts.join(', ')}. The baseline model was fitted to these ratios alone. The extended model is fitted to all runs, including cleat and K&C runs, each with its own uncertainty. It may therefore fit the sweeps less closely and all runs together better.`;
}

// `a, b and c`
function together(names) {
  return names.length > 1 ? `${names.slice(0, -1).join(', ')} and ${names[names.length - 1]}` : names.join('');
}

function placed(effect) {
  return `${words(effect.name)} at ${words(effect.at)}`;
}

// The title of an effect. Those of a class belong to alternatives.
function effectTitle(effect, effects) {
  if (!effect.one_of) return placed(effect);
  const own = alternatives(effects).findIndex((alternative) => alternative.includes(effect));
  if (alternatives(effects)[own][0] !== effect) return `With ${placed(effect)}`;
  return `${own === 0 ? 'Either' : 'Or'} ${placed(effect)}`;
}

// The effects of each alternative of a class, the most probable alternative first.
function alternatives(effects) {
  const some = effects.filter((effect) => effect.one_of);
  const numbers = [...new Set(some.map(({ alternative }) => alternative))];
  return numbers.map((number) => some.filter(({ alternative }) => alternative === number));
}

// The effects that the extended model adds to the baseline; `null` if there are none.
function added(effects) {
  const own = effects.filter((effect) => !effect.one_of).concat(alternatives(effects)[0] || []);
  return own.length ? own.map(placed).join(' and ') : null;
}
