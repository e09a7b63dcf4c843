FROM python:3.13-slim
RUN apt-get update && apt-get install --yes --no-install-recommends make git
WORKDIR /spherical-clearance-joint-study
COPY . .
RUN make setup
CMD ["make", "reproduce"]
