#include "services/viewer/address/qr_code.hpp"

#include <gtest/gtest.h>
#include <qrencode.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <opencv2/imgproc.hpp>
#include <opencv2/objdetect.hpp>
#include <regex>
#include <vector>

namespace luminav {
namespace {

/// The picture as a printer prints it, `scale` dots a module.
cv::Mat print(const std::string& svg, int scale) {
  std::smatch found;
  std::regex_search(svg, found, std::regex(R"(viewBox="0 0 (\d+) )"));
  const int size = std::stoi(found[1]);
  cv::Mat paper(size, size, CV_8U, cv::Scalar(255));
  const std::regex bar(R"(M(\d+) (\d+)h(\d+)v1h-\d+z)");
  for (auto at = std::sregex_iterator(svg.begin(), svg.end(), bar); at != std::sregex_iterator(); ++at) {
    paper(cv::Rect(std::stoi((*at)[1]), std::stoi((*at)[2]), std::stoi((*at)[3]), 1)) = 0;
  }
  cv::Mat printed;
  cv::resize(paper, printed, {}, scale, scale, cv::INTER_NEAREST);
  return printed;
}

TEST(QrCode, IsASquareOfBlackAndWhiteAndGrowsWithItsText) {
  const std::string code = qr_code("http://192.168.7.4:8080/#token=0123456789abcdef01234567");
  const auto lines = std::count(code.begin(), code.end(), '\n');
  EXPECT_GE(lines, 14);
  EXPECT_NE(code.find("\033[30;107m"), std::string::npos) << "black on white whatever the terminal's colours are";
  const std::string longer = qr_code(std::string(300, 'x'));
  EXPECT_GT(std::count(longer.begin(), longer.end(), '\n'), lines);
  EXPECT_EQ(qr_code(std::string(5000, 'x')), "");
}

TEST(QrCode, IsPrintedModuleByModuleWithinItsMargin) {
  const std::string address = "http://192.168.7.4:8080/?job=guide&place=office%207#token=0123456789abcdef01234567";
  const std::unique_ptr<QRcode, decltype(&QRcode_free)> code(
      QRcode_encodeString(address.c_str(), 0, QR_ECLEVEL_M, QR_MODE_8, 1), QRcode_free);
  const cv::Mat paper = print(qr_picture(address), 1);
  ASSERT_EQ(paper.cols, code->width + 8);
  for (int row = 0; row < paper.rows; ++row) {
    for (int column = 0; column < paper.cols; ++column) {
      const bool is_code = row >= 4 && column >= 4 && row < code->width + 4 && column < code->width + 4;
      const bool is_black = is_code && (code->data[(row - 4) * code->width + column - 4] & 1) != 0;
      EXPECT_EQ(paper.at<std::uint8_t>(row, column) == 0, is_black) << row << " " << column;
    }
  }
}

TEST(QrCode, IsFoundOnPaperByAnotherLibrary) {
  constexpr int kScale = 8;
  const cv::Mat paper = print(qr_picture("http://192.168.7.4:8080/?job=guide&place=lift"), kScale);
  std::vector<cv::Point2f> corners;
  ASSERT_TRUE(cv::QRCodeDetector().detect(paper, corners));
  EXPECT_NEAR(corners.at(0).x, 4.0F * kScale, kScale);
  EXPECT_NEAR(corners.at(0).y, 4.0F * kScale, kScale);
  EXPECT_NEAR(corners.at(2).x, static_cast<float>(paper.cols - 4 * kScale), kScale);
}

TEST(QrCode, IsNoPictureOfATextThatIsTooLong) {
  EXPECT_EQ(qr_picture(std::string(5000, 'x')), "");
}

}  // namespace
}  // namespace luminav
