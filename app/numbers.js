// Numbers as they go into a sentence, on the page and in exported files: to the letter the forms of app/names_and_units.py, with
// the limits and marks that it gives.
const numbers = (() => {
  const {prefixes, superscripts, ratios, percents, powers, nothing, marks: [point, comma]} = NUMBER_FORMATS;
  const localised = text => text.replace(/[.,]/g, mark => mark === "." ? point : comma);

  // What toFixed or toExponential writes, but what lies midway between two goes to the even one, as in Python.
  function rounded(value, form, places) {
    const [exact, power] = value[form](40).split("e"), dot = exact.indexOf("."), cut = exact.slice(0, dot + (places && places + 1));
    const midway = /^50*$/.test(exact.slice(dot + 1 + places)) && "02468".includes(cut.slice(-1));
    return !midway ? value[form](places) : power ? `${cut}e${power}` : cut;
  }

  // So many digits, an exponent only for what is very large or small: Python's "g".
  function general(value, digits) {
    if (!Number.isFinite(value)) return {NaN: "nan", Infinity: "inf", "-Infinity": "-inf"}[value];
    if (value === 0) return Object.is(value, -0) ? "-0" : "0";
    const [mantissa, power] = rounded(value, "toExponential", digits - 1).split("e");
    const plain = text => text.includes(".") ? text.replace(/\.?0+$/, "") : text;
    if (+power >= -4 && +power < digits) return plain(Number(`${mantissa}e${power}`).toFixed(Math.max(0, digits - 1 - power)));
    return `${plain(mantissa)}e${power[0]}${power.slice(1).padStart(2, "0")}`;
  }
  const number = (value, digits = 3) => localised(general(value, digits));

  // So many decimals: Python's "f", below 1e21; and none, with marks between thousands.
  const fixed = (value, places) =>
    Number.isFinite(value) ? localised((Object.is(value, -0) ? "-" : "") + rounded(value, "toFixed", places)) : number(value);
  const whole = value => localised(rounded(value, "toFixed", 0).replace(/\B(?=(\d{3})+$)/g, ","));

  // A size with its unit and a prefix that keeps it short: 2.1 mm, 340 kPa.
  function withUnit(value, unit, digits = 3) {
    if (!Number.isFinite(value) || value === 0) return `${number(value)} ${unit}`;
    const short = rounded(value, "toExponential", digits - 1);
    const third = Math.floor(Math.floor(Math.log10(Math.abs(Number(short)))) / 3);
    if (!(third in prefixes)) return `${localised(short)} ${unit}`;
    return `${number(Number(general(value / 1000 ** third, digits)), 6)} ${prefixes[third]}${unit}`;
  }

  // An estimate over what it is an estimate of: 0.36, 1.02, 6 × 10⁴.
  function ratio(value) {
    if (ratios[0] < value && value < ratios[1]) return fixed(value, 2);
    const [digits, power] = general(value, 1).split("e");
    return power ? `${digits} × ${powerText(+power).trim()}` : localised(digits);
  }

  // A share to two digits: 0.29 %, 6.4 %, 53 %, 2,300 %.
  function perCent(share) {
    const percent = 100 * share, [least, most, withoutDecimals] = percents;
    if (percent >= withoutDecimals && percent < most) return `${whole(percent)} %`;
    return `${percent === 0 || (percent > least && percent < most) ? number(percent, 2) : ratio(percent)} %`;
  }

  const powerText = power => power === 0 ? "" : "10" + [...String(power)].map(sign => superscripts[sign]).join("") + " ";

  // The power of ten to take out of numbers up to the largest.
  function powerOfTen(largest) {
    const power = largest > 0 && largest < Infinity ? Math.floor(Math.log10(largest)) : 0;
    return powers[0] <= power && power <= powers[1] ? 0 : power;
  }

  return {number, fixed, whole, withUnit, ratio, perCent, powerText, powerOfTen, prefixes, nothing};
})();
