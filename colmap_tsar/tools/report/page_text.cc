// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/report/page_text.h"

#include "colmap_tsar/base/text_stream.h"

#include <algorithm>
#include <cstddef>
#include <string_view>

#include <boost/algorithm/string/replace.hpp>

namespace tsar {
namespace {

constexpr size_t kMaxNameLength = 50;

// From the beginning to the title, and from there to the content.
constexpr std::string_view kBeforeTitle = R"html(<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<link rel="icon" href="data:,">
<title>)html";
constexpr std::string_view kAfterTitle = R"html(</title>
<style>
:root { color-scheme: light dark; --line: #8886; --track: #8883; }
body { margin: 0 auto; max-width: 90rem; padding: 1rem; font: 16px/1.5 sans-serif; }
h1, h2 { line-height: 1.25; overflow-wrap: anywhere; }
section { margin-top: 2.5rem; border-top: 1px solid var(--line); }
.pictures { display: flex; flex-wrap: wrap; gap: 1rem; }
figure { margin: 0; flex: 1 1 26rem; min-width: 0; max-width: 48rem; }
img { display: block; width: 100%; height: auto; background: var(--track); }
.compare { position: relative; --cut: 50%; }
.compare img + img { position: absolute; inset: 0; height: 100%; clip-path: inset(0 0 0 var(--cut)); }
.compare input { position: absolute; inset: 0; width: 100%; height: 100%; margin: 0; opacity: 0.4; cursor: ew-resize; }
.table { overflow-x: auto; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; }
th, td { padding: 0.2rem 0.7rem; border-bottom: 1px solid var(--line); text-align: right; }
th:first-child, td:first-child, td:last-child { text-align: left; overflow-wrap: anywhere; }
.swatch { display: inline-block; width: 0.8em; height: 0.8em; border: 1px solid var(--line); }
</style>
</head>
<body>
)html";
// A slider moves the border between the picture before and the one after.
constexpr std::string_view kEnd = R"html(<script>
document.addEventListener("input", (event) => {
  event.target.parentElement.style.setProperty("--cut", event.target.value + "%");
});
</script>
</body>
</html>
)html";

bool IsPlain(char c) {
  return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') ||
         (c >= 'a' && c <= 'z') || c == '-' || c == '.';
}

std::string Percent(double share) {
  return Formatted("%.1f %%", 100.0 * share);
}

std::string Cell(const std::string& html) { return "<td>" + html + "</td>"; }

// The color and the name of a value of provenance maps.
std::string KindHtml(size_t value) {
  const Rgb& color = kProvenanceColors[value];
  return Formatted(
      "<span class=\"swatch\" style=\"background: "
      "#%02x%02x%02x\"></span> %s",
      color.r,
      color.g,
      color.b,
      kProvenanceNames[value]);
}

void PutKinds(std::ostream& html) {
  html << "<p>";
  for (size_t value = 0; value < kProvenanceNames.size(); ++value) {
    html << KindHtml(value) << "&ensp;\n";
  }
  html << "</p>\n";
}

void BeginTable(const std::string& title,
                const std::vector<std::string>& columns,
                std::ostream& html) {
  html << "<section>\n<h2>" << title
       << "</h2>\n<div class=\"table\">\n<table>\n<tr>";
  for (const std::string& column : columns) {
    html << "<th>" << column << "</th>";
  }
  html << "</tr>\n";
}

void EndTable(std::ostream& html) { html << "</table>\n</div>\n</section>\n"; }

// The means of all images, each weighted by its pixels.
ImagePage MeanOf(const std::vector<ImagePage>& images) {
  ImagePage mean;
  double num_all = 0.0;
  for (const ImagePage& image : images) {
    const double num_pixels = static_cast<double>(image.width) * image.height;
    num_all += num_pixels;
    mean.share_before += num_pixels * image.share_before;
    mean.share_after += num_pixels * image.share_after;
    for (size_t value = 0; value < kProvenanceNames.size(); ++value) {
      mean.shares_by_provenance[value] +=
          num_pixels * image.shares_by_provenance[value];
    }
    mean.seconds += image.seconds / static_cast<double>(images.size());
  }
  mean.share_before /= num_all;
  mean.share_after /= num_all;
  for (double& share : mean.shares_by_provenance) {
    share /= num_all;
  }
  return mean;
}

// name: as HTML.
void PutRow(const std::string& name,
            const ImagePage& image,
            std::ostream& html) {
  html << "<tr>" << Cell(name) << Cell(Percent(image.share_before))
       << Cell(Percent(image.share_after));
  for (size_t value = 1; value < kProvenanceNames.size(); ++value) {
    html << Cell(Percent(image.shares_by_provenance[value]));
  }
  html << Cell(image.seconds > 0.0 ? Formatted("%.2f", image.seconds) : "")
       << Cell(EscapeHtml(image.note)) << "</tr>\n";
}

void PutTable(const std::vector<ImagePage>& images, std::ostream& html) {
  std::vector<std::string> columns = {"Image", "Depth before", "Depth after"};
  for (size_t value = 1; value < kProvenanceNames.size(); ++value) {
    columns.push_back(KindHtml(value));
  }
  columns.insert(columns.end(), {"Seconds", "Note"});
  BeginTable("Numbers", columns, html);
  PutRow("<b>mean</b>", MeanOf(images), html);
  for (size_t i = 0; i < images.size(); ++i) {
    const std::string link = "<a href=\"#image-" + std::to_string(i) + "\">";
    PutRow(link + EscapeHtml(images[i].name) + "</a>", images[i], html);
  }
  EndTable(html);
}

// Puts the pictures of an image, each with what it shows.
class PicturePutter {
 public:
  PicturePutter(const ImagePage& image, std::ostream& html)
      : image_(image), html_(html) {}

  void Put(const std::string& file, const std::string& caption) {
    html_ << "<figure>" << Picture(file, caption);
    PutCaption(caption);
  }
  void PutSlider(const std::string& name, const std::string& caption) {
    html_ << "<figure><div class=\"compare\">"
          << Picture(name + "_before.png", caption + ", before")
          << Picture(name + "_after.png", caption + ", after")
          << "<input type=\"range\" step=\"any\" aria-label=\"" << caption
          << ": before and after\"></div>";
    PutCaption(caption + ": before on the left, after on the right");
  }

 private:
  std::string Picture(const std::string& file, const std::string& text) const {
    return "<img loading=\"lazy\" src=\"images/" + image_.folder + "/" + file +
           "\" alt=\"" + text + "\" width=\"" +
           std::to_string(image_.picture_width) + "\" height=\"" +
           std::to_string(image_.picture_height) + "\">";
  }
  void PutCaption(const std::string& caption) {
    html_ << "<figcaption>" << caption << "</figcaption></figure>\n";
  }

  const ImagePage& image_;
  std::ostream& html_;
};

void PutImage(size_t index, const ImagePage& image, std::ostream& html) {
  html << "<section id=\"image-" << index << "\">\n<h2>"
       << EscapeHtml(image.name) << "</h2>\n<p>Maps of " << image.width
       << " &times; " << image.height << " pixels; "
       << Percent(image.share_before) << " have a depth before, "
       << Percent(image.share_after) << " after. "
       << "<a href=\"#\">All images</a></p>\n<div class=\"pictures\">\n";
  PicturePutter pictures(image, html);
  pictures.Put("photo.jpg", "Photo");
  pictures.PutSlider("depth",
                     "Depth from " + Formatted("%.4g", image.range.nearest) +
                         " (red) to " +
                         Formatted("%.4g", image.range.farthest) + " (blue)");
  pictures.Put("provenance.png", "What each depth is");
  if (image.has_confidence) {
    pictures.Put("confidence.png", "Confidence from 0 (dark) to 1 (yellow)");
  }
  pictures.PutSlider("normals", "Normals");
  if (image.has_planes) {
    pictures.Put("planes.png", "Planes of the scene");
  }
  html << "</div>\n</section>\n";
}

}  // namespace

std::string PageHtml(const PageData& data) {
  TextStream html;
  const std::string title = EscapeHtml(data.workspace);
  html << kBeforeTitle << title << kAfterTitle << "<h1>" << title
       << "</h1>\n<p>" << data.images.size() << " refined images, "
       << EscapeHtml(data.type)
       << " maps. Black in a picture is no depth.</p>\n";
  PutKinds(html);
  PutTable(data.images, html);
  for (size_t i = 0; i < data.images.size(); ++i) {
    PutImage(i, data.images[i], html);
  }
  if (!data.kept.empty()) {
    BeginTable("Images left as they were", {"Image", "Reason"}, html);
    for (const RunSummary::KeptImage& image : data.kept) {
      html << "<tr>" << Cell(EscapeHtml(image.name))
           << Cell(EscapeHtml(image.reason)) << "</tr>\n";
    }
    EndTable(html);
  }
  if (!data.options.empty()) {
    BeginTable("Options of the run", {"Option", "Value"}, html);
    for (const auto& [name, value] : data.options) {
      html << "<tr>" << Cell(EscapeHtml(name)) << Cell(EscapeHtml(value))
           << "</tr>\n";
    }
    EndTable(html);
  }
  html << "<p>Made by colmap_tsar " << EscapeHtml(data.version)
       << " tsar_report.</p>\n"
       << kEnd;
  return html.str();
}

std::string EscapeHtml(const std::string& text) {
  std::string escaped = text;
  boost::replace_all(escaped, "&", "&amp;");  // First, since others add it.
  boost::replace_all(escaped, "<", "&lt;");
  boost::replace_all(escaped, ">", "&gt;");
  boost::replace_all(escaped, "\"", "&quot;");
  boost::replace_all(escaped, "'", "&#39;");
  return escaped;
}

std::string SafeFileName(int index, const std::string& image_name) {
  std::string plain = image_name.substr(0, kMaxNameLength);
  std::ranges::replace_if(
      plain, [](char c) { return !IsPlain(c); }, '_');
  // A trailing dot, or two dots, are special in some file systems.
  boost::replace_all(plain, "..", "_");
  return Formatted("%05d_", index) + plain + (plain.ends_with('.') ? "_" : "");
}

}  // namespace tsar
