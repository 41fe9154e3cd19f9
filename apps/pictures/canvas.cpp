// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "canvas.h"

#include <iconv.h>
#include <vtkActor2D.h>
#include <vtkCellArray.h>
#include <vtkImageData.h>
#include <vtkImageMapper.h>
#include <vtkLogger.h>
#include <vtkOpenGLRenderWindow.h>
#include <vtkPNGWriter.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper2D.h>
#include <vtkProperty2D.h>
#include <vtkRenderer.h>
#include <vtkRendererCollection.h>
#include <vtkStringOutputWindow.h>
#include <vtkTextActor.h>
#include <vtkTextProperty.h>
#include <vtkUnsignedCharArray.h>
#include <vtkWindowToImageFilter.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <ostream>

#include "palpate/core/error.h"
#include "palpate/core/output_file.h"

namespace palpate::pictures {
namespace {

constexpr int kTitleSize = 26;
constexpr int kSubtitleSize = 16;
constexpr double kTitleCenter = 34;     ///< px from the top
constexpr double kSubtitleCenter = 66;  ///< px from the top
constexpr double kSubtitleTop = 56;     ///< px from the top
constexpr double kTitleHeight = 86;     ///< px from the top
constexpr double kTitleMargin = 20;     ///< px, each side
constexpr double kBarEnd = 8;           ///< px
constexpr double kBarText = 20;         ///< px above the bar
constexpr int kMarkerCorners = 16;
constexpr double kShortestStep = 0.7;  ///< px; nearer points of a line are one
constexpr double kLongestCorner = 2;   ///< of half the line's width, where a line turns

/// Samples a pixel for smooth edges; what Mesa's software renderer offers.
constexpr int kSamples = 4;

std::array<double, 3> to_unit(const Rgb& color) {
  return {color[0] / 255.0, color[1] / 255.0, color[2] / 255.0};
}

int justification(Align align) {
  // The three constants of VTK for left, centred and right are those for bottom, centred and top.
  return align == Align::low      ? VTK_TEXT_LEFT
         : align == Align::middle ? VTK_TEXT_CENTERED
                                  : VTK_TEXT_RIGHT;
}

bool is_utf8(std::string text) {
  const iconv_t converter = iconv_open("UTF-32", "UTF-8");
  std::string converted(4 * (text.size() + 1), '\0');  // with a byte order mark
  char* from = text.data();
  char* to = converted.data();
  std::size_t from_left = text.size();
  std::size_t to_left = converted.size();
  const std::size_t result = iconv(converter, &from, &from_left, &to, &to_left);
  iconv_close(converter);
  return result != static_cast<std::size_t>(-1);
}

/// VTK takes UTF-8 only; a title may hold a file's name, which can be anything.
std::string printable(std::string text) {
  if (!is_utf8(text)) {
    std::replace_if(
        text.begin(), text.end(), [](char byte) { return (byte & 0x80) != 0; }, '?');
  }
  return text;
}

void set_style(vtkTextProperty* property, const TextStyle& style) {
  property->SetFontFamilyToArial();
  property->SetFontSize(style.size);
  property->SetColor(to_unit(style.color).data());
  property->SetBold(style.bold);
  property->SetJustification(justification(style.across));
  property->SetVerticalJustification(justification(style.up));
  property->SetOrientation(style.upwards ? 90 : 0);
}

vtkSmartPointer<vtkActor2D> flat_actor(vtkPolyData* shape, const Rgb& color) {
  const vtkNew<vtkPolyDataMapper2D> mapper;
  mapper->SetInputData(shape);
  auto actor = vtkSmartPointer<vtkActor2D>::New();
  actor->SetMapper(mapper);
  actor->GetProperty()->SetColor(to_unit(color).data());
  return actor;
}

/// Appends a band around the line through `points`. Lines of OpenGL would show gaps where steps are
/// shorter than a pixel.
void add_band(const std::vector<Eigen::Vector2d>& points, double half_width, vtkPoints* corners,
              vtkCellArray* quads) {
  const auto across = [&points](std::size_t from) -> Eigen::Vector2d {
    return (points[from + 1] - points[from]).unitOrthogonal();
  };
  for (std::size_t index = 0; points.size() > 1 && index < points.size(); ++index) {
    const Eigen::Vector2d before = across(index == 0 ? 0 : index - 1);
    const Eigen::Vector2d after = across(std::min(index, points.size() - 2));
    // The corner of both bands is at the bisector, further out the sharper the turn.
    const Eigen::Vector2d bisector = before + after;
    const double stretch =
        2 / std::max(bisector.squaredNorm(), 4 / (kLongestCorner * kLongestCorner));
    const Eigen::Vector2d side = half_width * stretch * bisector;
    const Eigen::Vector2d one = points[index] + side;
    const Eigen::Vector2d other = points[index] - side;
    corners->InsertNextPoint(one.x(), one.y(), 0);
    const vtkIdType last = corners->InsertNextPoint(other.x(), other.y(), 0);
    if (index > 0) {
      quads->InsertNextCell({last - 3, last - 2, last, last - 1});
    }
  }
}

/// The window of all pictures on a connection. Its OpenGL context and the programs that this
/// compiles take longer than most drawings: it stays until the process ends.
vtkOpenGLRenderWindow* window_on(void* connection) {
  static vtkOpenGLRenderWindow* window = nullptr;
  if (window == nullptr || window->GetGenericDisplayId() != connection) {
    window = dynamic_cast<vtkOpenGLRenderWindow*>(vtkRenderWindow::New());
    window->SetDisplayId(connection);
    window->SetOffScreenRendering(1);
    window->SetShowWindow(false);
    window->SetMultiSamples(kSamples);
    window->SetNumberOfLayers(2);
    window->SetFrameBlitModeToNoBlit();  // nobody looks at the window itself
  }
  return window;
}

}  // namespace

Canvas::Canvas(int height, const std::string& title, const std::string& subtitle)
    : previous_messages_(vtkOutputWindow::GetInstance()),
      height_(height),
      top_(height - (subtitle.empty() ? kSubtitleTop : kTitleHeight)) {
  // VTK reports on the console; a library does not. Messages are read in `write`.
  vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_OFF);
  vtkOutputWindow::SetInstance(messages_);
  window_ = window_on(display_.handle());
  window_->SetSize(kWidth, height);
  const vtkNew<vtkRenderer> paper;
  paper->SetBackground(1, 1, 1);
  window_->AddRenderer(paper);
  flat_->SetLayer(1);
  window_->AddRenderer(flat_);

  const double middle = kWidth / 2.0;
  TextStyle style{.size = kTitleSize, .color = kBlack, .bold = true};
  const double widest = kWidth - 2 * kTitleMargin;
  const double wanted = text_size(title, style).x();
  style.size =
      wanted > widest ? std::max(1, static_cast<int>(kTitleSize * widest / wanted)) : kTitleSize;
  add_text({middle, height - kTitleCenter}, title, style);
  if (!subtitle.empty()) {
    add_text({middle, height - kSubtitleCenter}, subtitle, {.size = kSubtitleSize, .color = kGrey});
  }
}

Canvas::~Canvas() {
  while (vtkRenderer* renderer = window_->GetRenderers()->GetFirstRenderer()) {
    window_->RemoveRenderer(renderer);
  }
  window_->ReleaseCurrent();  // another thread may draw the next picture
  vtkOutputWindow::SetInstance(previous_messages_);
}

void Canvas::add_text(const Eigen::Vector2d& at, const std::string& text, const TextStyle& style) {
  const vtkNew<vtkTextActor> actor;
  actor->SetInput(printable(text).c_str());
  actor->SetTextScaleModeToNone();
  set_style(actor->GetTextProperty(), style);
  actor->SetPosition(at.x(), at.y());
  flat_->AddActor(actor);
}

Eigen::Vector2d Canvas::text_size(const std::string& text, const TextStyle& style) const {
  const vtkNew<vtkTextActor> actor;
  actor->SetInput(printable(text).c_str());
  actor->SetTextScaleModeToNone();
  set_style(actor->GetTextProperty(), style);
  std::array<double, 2> size{};
  actor->GetSize(flat_, size.data());
  return {size[0], size[1]};
}

void Canvas::add_line(const Eigen::Ref<const Eigen::Matrix2Xd>& points, const Rgb& color,
                      double width) {
  const vtkNew<vtkPoints> corners;
  const vtkNew<vtkCellArray> quads;
  std::vector<Eigen::Vector2d> run;
  for (Eigen::Index index = 0; index <= points.cols(); ++index) {
    const bool goes_on = index < points.cols() && points.col(index).allFinite();
    if (!goes_on) {
      add_band(run, width / 2, corners, quads);
      run.clear();
    } else if (run.empty() || (points.col(index) - run.back()).norm() >= kShortestStep) {
      run.emplace_back(points.col(index));
    }
  }
  const vtkNew<vtkPolyData> shape;
  shape->SetPoints(corners);
  shape->SetPolys(quads);
  flat_->AddActor(flat_actor(shape, color));
}

void Canvas::add_markers(const Eigen::Ref<const Eigen::Matrix2Xd>& centers, const Rgb& color,
                         double size) {
  const vtkNew<vtkPoints> places;
  const vtkNew<vtkCellArray> disks;
  for (Eigen::Index index = 0; index < centers.cols(); ++index) {
    if (!centers.col(index).allFinite()) {
      continue;
    }
    disks->InsertNextCell(kMarkerCorners);
    for (int corner = 0; corner < kMarkerCorners; ++corner) {
      const double angle = 2 * std::numbers::pi * corner / kMarkerCorners;
      disks->InsertCellPoint(places->InsertNextPoint(centers(0, index) + size / 2 * std::cos(angle),
                                                     centers(1, index) + size / 2 * std::sin(angle),
                                                     0));
    }
  }
  const vtkNew<vtkPolyData> shape;
  shape->SetPoints(places);
  shape->SetPolys(disks);
  flat_->AddActor(flat_actor(shape, color));
}

void Canvas::add_rectangle(const Box& box, const Rgb& color) {
  const vtkNew<vtkPoints> corners;
  corners->InsertNextPoint(box.x, box.y, 0);
  corners->InsertNextPoint(box.x + box.width, box.y, 0);
  corners->InsertNextPoint(box.x + box.width, box.y + box.height, 0);
  corners->InsertNextPoint(box.x, box.y + box.height, 0);
  const vtkNew<vtkCellArray> cells;
  cells->InsertNextCell({0, 1, 2, 3});
  const vtkNew<vtkPolyData> shape;
  shape->SetPoints(corners);
  shape->SetPolys(cells);
  flat_->AddActor(flat_actor(shape, color));
}

void Canvas::add_outline(const Box& box) {
  Eigen::Matrix2Xd corners(2, 5);
  corners << box.x, box.x + box.width, box.x + box.width, box.x, box.x,  //
      box.y, box.y, box.y + box.height, box.y + box.height, box.y;
  add_line(corners, kGrey);
}

void Canvas::add_bar(const Eigen::Vector2d& at, double length, const std::string& text) {
  Eigen::Matrix2Xd bar(2, 4);
  bar << 0, 0, length, length, kBarEnd, 0, 0, kBarEnd;
  add_line(bar.colwise() + at, kBlack, 2);
  const TextStyle style;
  // A short bar's text starts at the bar's start, lest it run off the picture.
  const double middle = std::max(length, text_size(text, style).x()) / 2;
  add_text(at + Eigen::Vector2d(middle, kBarText), text, style);
}

void Canvas::add_pixels(const Eigen::Vector2d& lower_left, const Pixels& pixels) {
  const vtkNew<vtkImageData> image;
  image->SetDimensions(pixels.width, pixels.height, 1);
  image->AllocateScalars(VTK_UNSIGNED_CHAR, 3);
  auto* target = static_cast<Rgb*>(image->GetScalarPointer());
  std::copy(pixels.colors.begin(), pixels.colors.end(), target);
  const vtkNew<vtkImageMapper> mapper;
  mapper->SetInputData(image);
  mapper->SetColorWindow(255);
  mapper->SetColorLevel(127.5);
  const vtkNew<vtkActor2D> actor;
  actor->SetMapper(mapper);
  actor->SetPosition(lower_left.x(), lower_left.y());
  flat_->AddActor(actor);
}

vtkRenderer* Canvas::add_panel(const Box& box) {
  const vtkNew<vtkRenderer> panel;
  panel->SetBackground(1, 1, 1);
  panel->SetViewport(box.x / kWidth, box.y / height_, (box.x + box.width) / kWidth,
                     (box.y + box.height) / height_);
  window_->AddRenderer(panel);
  return panel;
}

void Canvas::write(const std::filesystem::path& png) {
  const vtkNew<vtkWindowToImageFilter> shot;
  shot->SetInput(window_);
  shot->ReadFrontBufferOff();
  const vtkNew<vtkPNGWriter> writer;
  writer->SetInputConnection(shot->GetOutputPort());
  writer->WriteToMemoryOn();
  writer->Write();
  const std::string complaint = messages_->GetOutput();
  if (complaint.find("ERROR") != std::string::npos) {
    throw OutputError(png.string() + ": cannot draw: " + complaint);
  }
  vtkUnsignedCharArray* bytes = writer->GetResult();
  write_file(png, [bytes](std::ostream& out) {
    out.write(reinterpret_cast<const char*>(bytes->GetPointer(0)), bytes->GetNumberOfValues());
  });
}

}  // namespace palpate::pictures
