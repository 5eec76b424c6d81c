flat in uint id;

layout(location = 0) out uint pixelId;

void main() { pixelId = id; }
