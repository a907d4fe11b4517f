#include "solver/linear/form_factor_rows.h"

#include <algorithm>

#include "pipeline/system/vector_code.h"
#include "solver/linear/parallel_rows.h"

namespace patchlight {

namespace {

/// Adds what stands at `places` of a table [elements][kWidth] to `sum` [kWidth]. Eight by eight are added as they are
/// stored, in pairs: where they are equal that is exact.
template <class Number, int kWidth>
VECTOR_CODE void add_equal(std::span<const std::int32_t> places, const Number* table, double* sum) {
  const auto at = [&](std::size_t k) { return table + std::size_t(places[k]) * kWidth; };
  double total[kWidth] = {};
  std::size_t k = 0;
  for (; k + 8 <= places.size(); k += 8) {
    const Number *a = at(k), *b = at(k + 1), *c = at(k + 2), *d = at(k + 3);
    const Number *e = at(k + 4), *f = at(k + 5), *g = at(k + 6), *h = at(k + 7);
    for (int i = 0; i < kWidth; ++i)
      total[i] += double(((a[i] + b[i]) + (c[i] + d[i])) + ((e[i] + f[i]) + (g[i] + h[i])));
  }
  for (; k < places.size(); ++k)
    for (int i = 0; i < kWidth; ++i) total[i] += double(at(k)[i]);
  for (int i = 0; i < kWidth; ++i) sum[i] += total[i];
}

/// The same, each times its weight.
template <class Number, int kWidth>
VECTOR_CODE void add_weighted(std::span<const std::int32_t> places, const float* weights, const Number* table,
                              double* sum) {
  for (std::size_t k = 0; k < places.size(); ++k) {
    const Number* const values = table + std::size_t(places[k]) * kWidth;
    for (int i = 0; i < kWidth; ++i) sum[i] += double(values[i]) * double(weights[k]);
  }
}

}  // namespace

FormFactorRows::FormFactorRows(const TransportRows& rows, int sky) : transport_(rows), sky_(sky) {
  if (rows.mirrored.empty()) return;
  mirrored_starts_.assign(rows.starts.size(), 0);
  for (const auto& m : rows.mirrored) ++mirrored_starts_[2 * m.row + m.sample_set + 1];
  for (std::size_t k = 1; k < mirrored_starts_.size(); ++k) mirrored_starts_[k] += mirrored_starts_[k - 1];
}

template <class Number, int kWidth>
void FormFactorRows::receive_packed(const RadiosityTable& radiosity, std::span<const Receiver> receivers) const {
  const Number* const table = radiosity.values<Number>();
  const auto sample_set = [&](std::size_t k, double* sum) {
    const std::uint64_t begin = transport_.starts[k];
    const auto places = std::span(transport_.columns).subspan(begin, transport_.starts[k + 1] - begin);
    std::fill(sum, sum + kWidth, 0.0);
    if (transport_.rays == 0) {
      add_weighted<Number, kWidth>(places, transport_.weights.data() + begin, table, sum);
    } else {
      add_equal<Number, kWidth>(places, table, sum);
      for (int c = 0; c < kWidth; ++c) sum[c] *= double(transport_.hit_weights[k]);
    }
    if (mirrored_starts_.empty()) return;
    for (std::uint64_t at = mirrored_starts_[k]; at < mirrored_starts_[k + 1]; ++at) {
      const auto& m = transport_.mirrored[at];
      for (std::size_t c = 0; c < 3 * receivers.size(); ++c)
        sum[c] += double(table[std::size_t(m.patch) * kWidth + c]) * double(m.weight[int(c % 3)]);
    }
  };
  for_each_row(std::size_t(transport_.rows()), [&](std::size_t i) {
    double first[kWidth], second[kWidth];
    sample_set(2 * i, first);
    sample_set(2 * i + 1, second);
    for (std::size_t f = 0; f < receivers.size(); ++f)
      for (int c = 0; c < 3; ++c) {
        const double a = first[3 * f + c], b = second[3 * f + c];
        (*receivers[f].irradiance)[i].c[c] = 0.5 * (a + b);
        if (receivers[f].deviation) (*receivers[f].deviation)[i].c[c] = 0.5 * (a - b);
      }
  });
}

template <class Number>
void FormFactorRows::receive_stored(const RadiosityTable& table, std::span<const Receiver> receivers) const {
  if (table.width() == 4)
    receive_packed<Number, 4>(table, receivers);
  else if (table.width() == 8)
    receive_packed<Number, 8>(table, receivers);
  else
    receive_packed<Number, 16>(table, receivers);
}

void FormFactorRows::receive(const RadiosityTable& table, std::span<const Receiver> receivers) const {
  if (table.precision() == Precision::single)
    receive_stored<float>(table, receivers);
  else
    receive_stored<double>(table, receivers);
}

void FormFactorRows::receive(std::span<const Exchange> fields, const SpectrumField* factor, Precision precision) const {
  if (fields.empty()) return;
  const std::size_t given = fields[0].radiosity->size();
  RadiosityTable table(fields.size(), sky_ > 0 ? std::size_t(transport_.rows()) + std::size_t(sky_) : given, precision);
  for_each_row(given, [&](std::size_t i) {
    for (std::size_t f = 0; f < fields.size(); ++f) {
      const Spectrum& value = (*fields[f].radiosity)[i];
      table.set(f, i, factor ? value * (*factor)[i] : value);
    }
  });
  std::vector<Receiver> receivers;
  for (const Exchange& field : fields) receivers.push_back(field.to);
  receive(table, receivers);
}

void FormFactorRows::receive(const SpectrumField& radiosity, SpectrumField& irradiance) const {
  const Exchange field{&radiosity, {&irradiance}};
  receive({&field, 1}, nullptr, Precision::full);
}

void FormFactorRows::receive_mirrored(const SpectrumField& radiosity, SpectrumField& irradiance,
                                      SpectrumField& deviation) const {
  std::fill(irradiance.begin(), irradiance.end(), Spectrum());
  std::fill(deviation.begin(), deviation.end(), Spectrum());
  for (const auto& m : transport_.mirrored) {
    if (std::size_t(m.patch) >= radiosity.size()) continue;  // the environment, left out
    const Spectrum received = radiosity[m.patch] * Spectrum(m.weight) * Spectrum(0.5);
    irradiance[m.row] += received;
    m.sample_set == 0 ? deviation[m.row] += received : deviation[m.row] -= received;
  }
}

SpectrumField FormFactorRows::seen() const {
  SpectrumField seen(std::size_t(transport_.rows()));
  for (std::size_t k = 0; k + 1 < transport_.starts.size(); ++k) {
    const std::uint64_t begin = transport_.starts[k], end = transport_.starts[k + 1];
    double sum = 0;
    const auto places = std::span(transport_.columns).subspan(begin, end - begin);
    const auto is_sky = [&](std::int32_t place) { return place >= transport_.rows(); };
    if (transport_.rays > 0)
      sum = double(std::int64_t(end - begin) - (sky_ > 0 ? std::count_if(places.begin(), places.end(), is_sky) : 0)) *
            double(transport_.hit_weights[k]);
    else
      for (std::uint64_t at = begin; at < end; ++at)
        if (sky_ == 0 || !is_sky(transport_.columns[at])) sum += double(transport_.weights[at]);
    seen[k / 2] += Spectrum(0.5 * sum);
  }
  for (const auto& m : transport_.mirrored)
    if (sky_ == 0 || m.patch < transport_.rows()) seen[m.row] += Spectrum(m.weight) * Spectrum(0.5);
  return seen;
}

}  // namespace patchlight
